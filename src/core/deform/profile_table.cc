#include "core/deform/profile_table.h"

#include <cmath>
#include <cstdint>

#include "palpate/surface.h"

namespace palpate::deform {
namespace {

constexpr std::size_t kTableSize = 1024;  // entries per R_6

}  // namespace

ProfileTable::ProfileTable(const model::FalloffRatios& reach, double rounding)
    : per_entry_(static_cast<float>(kTableSize)) {
  const DisplacementProfile profile(reach, 1.0, 1.0);
  const auto count = static_cast<std::size_t>(std::ceil(static_cast<double>(kTableSize) / (1.0 - rounding)));
  const auto u_at = [&](double i) {
    return profile.rounded_at(std::abs(i) / static_cast<double>(kTableSize) * profile.outer_radius(),
                              rounding);
  };
  for (std::size_t i = 0; i <= count + 1; ++i) {
    const double x = static_cast<double>(i);
    rows_.push_back({static_cast<float>(u_at(x)), 0.0F,
                     static_cast<float>((u_at(x + 0.5) - u_at(x - 0.5)) * static_cast<double>(kTableSize)),
                     0.0F});
  }
  rows_.push_back({});
  for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
    rows_[i][1] = rows_[i + 1][0] - rows_[i][0];
    rows_[i][3] = rows_[i + 1][2] - rows_[i][2];
  }
  last_ = static_cast<float>(rows_.size() - 1);
}

ProfileTable::Value4 ProfileTable::at(const Float4& y) const noexcept {
  const Float4 place = min(y * Float4(per_entry_), Float4(last_));
  std::array<std::int32_t, kLanes> entry{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) entry[lane] = static_cast<std::int32_t>(place.get(lane));
  const Float4 share =
      place - Float4(Float4::Value{static_cast<float>(entry[0]), static_cast<float>(entry[1]),
                                   static_cast<float>(entry[2]), static_cast<float>(entry[3])});
  std::array<Float4, kLanes> rows;  // u, its change, slope and its change, after the transposition
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    rows[lane] = Float4::load_unaligned(rows_[static_cast<std::size_t>(entry[lane])].data());
  transpose(rows);
  return {rows[0] + share * rows[1], rows[2] + share * rows[3]};
}

float ProfileTable::where(float share) const noexcept {
  const auto end =
      std::partition_point(rows_.begin(), rows_.end(), [share](const Row& row) { return row[0] >= share; });
  return static_cast<float>(end - rows_.begin()) / per_entry_;
}

}  // namespace palpate::deform
