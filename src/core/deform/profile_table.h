#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "core/base/simd.h"
#include "palpate/tissue.h"

namespace palpate::deform {

/// The displacement profile as a table. It is equal for all contacts up to scale: u(r)/D and its slope over
/// r/R_6 (docs/model.md, section 3).
class ProfileTable final {
 public:
  struct Value {
    float u = 0.0F;      // u/D
    float slope = 0.0F;  // d(u/D) / d(r/R_6)
  };
  struct Value4 {
    Float4 u, slope;
  };

  /// [setup] @param rounding as in DisplacementProfile::rounded_at
  ProfileTable(const model::FalloffRatios& reach, double rounding);

  /// [any] At r/R_6 >= 0, also at infinity; zero from the profile's end.
  [[nodiscard]] Value at(float y) const noexcept {
    const float place = std::min(y * per_entry_, last_);
    const auto i = static_cast<std::size_t>(place);
    const float share = place - static_cast<float>(i);
    const Row& row = rows_[i];
    return {row[0] + share * row[1], row[2] + share * row[3]};
  }
  /// [any] Four values at once.
  [[nodiscard]] Value4 at(const Float4& y) const noexcept;
  /// [any] r/R_6 from which u/D stays below `share`.
  [[nodiscard]] float where(float share) const noexcept;

 private:
  // Per entry: u, its change to the next entry, the slope and its change.
  using Row = std::array<float, 4>;

  float per_entry_ = 1.0F;  // entries per unit of r/R_6
  float last_ = 0.0F;       // last entry; all zero
  std::vector<Row> rows_;
};

}  // namespace palpate::deform
