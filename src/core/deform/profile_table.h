#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "core/base/lanes.h"
#include "palpate/tissue.h"

namespace palpate::deform {

/// The surface profile around contacts as a table, since every contact has the same up to scale: u(r)/D over
/// r/R_6 (model.md, section 3), and its slope.
class ProfileTable final {
 public:
  struct Value {
    float u = 0.0F;      // of D
    float slope = 0.0F;  // of D, over one R_6
  };
  struct LaneValue {
    Lanes u, slope;
  };

  /// [setup] @param rounding as of SurfaceProfile::rounded_at
  ProfileTable(const model::ReachParameters& reach, double rounding);

  /// [any] At r/R_6 >= 0, also infinite; zero from the profile's end on.
  [[nodiscard]] Value at(float y) const noexcept {
    const float place = std::min(y * per_entry_, last_);
    const auto i = static_cast<std::size_t>(place);
    const float share = place - static_cast<float>(i);
    const Row& row = rows_[i];
    return {row[0] + share * row[1], row[2] + share * row[3]};
  }
  /// [any] The same of four at once.
  [[nodiscard]] LaneValue at(const Lanes& y) const noexcept;
  /// [any] r/R_6 from which u stays below `share` of D.
  [[nodiscard]] float where(float share) const noexcept;

 private:
  // Of each entry u, its change to the next entry, the slope and its change.
  using Row = std::array<float, 4>;

  float per_entry_ = 1.0F;  // entries a unit of r/R_6
  float last_ = 0.0F;       // entry; all zero
  std::vector<Row> rows_;
};

}  // namespace palpate::deform
