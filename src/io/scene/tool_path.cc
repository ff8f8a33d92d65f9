#include "palpate/tool_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

/// Slopes of a monotone piecewise cubic per coordinate, which never overshoots two neighbouring rows: zero at
/// a coordinate's turning point, else the weighted harmonic mean of the adjacent slopes [Fritsch and Butland
/// 1984]. Zero at both ends, as outside the path.
std::vector<Vec3> monotone_slopes(const std::vector<PathRow>& rows) {
  std::vector<Vec3> slopes(rows.size(), Vec3::Zero());
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    const double before = rows[i].time - rows[i - 1].time;
    const double after = rows[i + 1].time - rows[i].time;
    const Vec3 slope_before = (rows[i].position - rows[i - 1].position) / before;
    const Vec3 slope_after = (rows[i + 1].position - rows[i].position) / after;
    const double weight_before = 2.0 * after + before;
    const double weight_after = after + 2.0 * before;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(slope_before[axis] * slope_after[axis] > 0.0)) continue;
      slopes[i][axis] = (weight_before + weight_after) /
                        (weight_before / slope_before[axis] + weight_after / slope_after[axis]);
    }
  }
  return slopes;
}

}  // namespace

const char* to_string(PathInterpolation interpolation) noexcept {
  return interpolation == PathInterpolation::kCubic ? "cubic" : "linear";
}

std::optional<PathInterpolation> interpolation_of(std::string_view name) noexcept {
  for (const PathInterpolation known : {PathInterpolation::kLinear, PathInterpolation::kCubic}) {
    if (name == to_string(known)) return known;
  }
  return std::nullopt;
}

ToolPath::ToolPath(std::vector<PathRow> rows, bool has_gripper, PathInterpolation interpolation)
    : rows_(std::move(rows)), has_gripper_(has_gripper) {
  if (rows_.empty()) throw InputError("a tool path must have at least one row");
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    if (rows_[i].time > rows_[i - 1].time) continue;
    throw InputError(fmt::format("time_s = {}: must be later than the row before, {}",
                                 shortest(rows_[i].time), shortest(rows_[i - 1].time)));
  }
  const double length = rows_.back().time - rows_.front().time;
  if (!std::isfinite(length)) {
    throw InputError(fmt::format("time_s = {} to {}: the path's length must be a finite number",
                                 shortest(rows_.front().time), shortest(rows_.back().time)));
  }
  if (interpolation == PathInterpolation::kCubic) slopes_ = monotone_slopes(rows_);
  if (length > 0.0) rows_per_second_ = static_cast<double>(rows_.size() - 1) / length;
}

std::size_t ToolPath::row_before(double time) const noexcept {
  // Most paths have evenly spaced rows. Then the row is the computed one, or by rounding the next.
  const double place = (time - rows_.front().time) * rows_per_second_;
  const std::size_t last = rows_.size() - 1;
  std::size_t i = place < static_cast<double>(last) ? static_cast<std::size_t>(place) : last;
  const auto has_begun = [&](std::size_t row) { return row < rows_.size() && rows_[row].time <= time; };
  if (has_begun(i + 1)) ++i;
  if (has_begun(i) && !has_begun(i + 1)) return i;
  const auto after = std::upper_bound(rows_.begin(), rows_.end(), time,
                                      [](double t, const PathRow& row) { return t < row.time; });
  return static_cast<std::size_t>(after - rows_.begin()) - 1;
}

ToolPath ToolPath::faster(double factor) const {
  ToolPath path = *this;
  for (PathRow& row : path.rows_) row.time /= factor;
  for (Vec3& slope : path.slopes_) slope *= factor;
  path.rows_per_second_ *= factor;
  return path;
}

PathRow ToolPath::at(double time) const noexcept {
  PathRow row;
  if (!(time > rows_.front().time)) {
    row = rows_.front();
  } else if (time >= rows_.back().time) {
    row = rows_.back();
  } else {
    const std::size_t i = row_before(time);
    const PathRow& a = rows_[i];
    const PathRow& b = rows_[i + 1];
    const double u = (time - a.time) / (b.time - a.time);
    row = a;
    if (u > 0.0) {
      row.position = (1.0 - u) * a.position + u * b.position;
      if (!slopes_.empty()) {  // cubic Hermite interpolation, as a correction of the straight line
        const Vec3 chord = b.position - a.position;
        const double period = b.time - a.time;
        row.position += u * (1.0 - u) *
                        ((1.0 - u) * (period * slopes_[i] - chord) - u * (period * slopes_[i + 1] - chord));
      }
      row.orientation = slerp(a.orientation, b.orientation, u);
      row.gripper = (1.0 - u) * a.gripper + u * b.gripper;
    }
  }
  row.time = time;
  return row;
}

Vec3 ToolPath::velocity_at(double time) const noexcept {
  if (!(time >= rows_.front().time) || time >= rows_.back().time) return Vec3::Zero();
  const std::size_t i = row_before(time);
  const double period = rows_[i + 1].time - rows_[i].time;
  const Vec3 chord = (rows_[i + 1].position - rows_[i].position) / period;
  if (slopes_.empty()) return chord;
  const double u = (time - rows_[i].time) / period;
  return 6.0 * u * (1.0 - u) * chord + (1.0 - u) * (1.0 - 3.0 * u) * slopes_[i] +
         u * (3.0 * u - 2.0) * slopes_[i + 1];
}

}  // namespace palpate::scene
