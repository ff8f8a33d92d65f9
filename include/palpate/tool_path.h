#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/pose.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// One row of a tool path.
struct PathRow {
  double time = 0.0;             // s
  Vec3 position = Vec3::Zero();  // m
  Quat orientation = Quat::Identity();
  double gripper = 0.0;       // 0 closed .. 1 open
  std::uint32_t buttons = 0;  // bits, pressed from this row to the next
};

/// A tool's motion over time. Between rows, positions follow PathInterpolation, orientations slerp, and the
/// gripper is interpolated linearly. Before the first and after the last row the pose is constant.
class ToolPath final {
 public:
  /// [setup] @param rows with unit quaternions @throws InputError when there are no rows, or when the times
  /// do not strictly increase.
  explicit ToolPath(std::vector<PathRow> rows, bool has_gripper = true,
                    PathInterpolation interpolation = PathInterpolation::kLinear);

  /// [setup] The same motion with the duration divided by `factor`; factor > 0.
  [[nodiscard]] ToolPath faster(double factor) const;

  /// [rt] The interpolated row at `time` [s].
  [[nodiscard]] PathRow at(double time) const noexcept;
  /// [rt] Velocity [m/s] at `time` [s]. The velocity at a row is that of the
  /// interval after it, and 0 outside the path.
  [[nodiscard]] Vec3 velocity_at(double time) const noexcept;
  [[nodiscard]] double end_time() const noexcept { return rows_.back().time; }
  [[nodiscard]] bool has_gripper() const noexcept { return has_gripper_; }
  [[nodiscard]] const std::vector<PathRow>& rows() const noexcept { return rows_; }

 private:
  /// Index of the last row at or before `time`; `time` is not before the first row.
  [[nodiscard]] std::size_t row_before(double time) const noexcept;

  std::vector<PathRow> rows_;
  std::vector<Vec3> slopes_;      // m/s, at each row; empty if linear
  double rows_per_second_ = 0.0;  // mean number of rows per second; 0 with one row
  bool has_gripper_;
};

/// [setup] The time of a path CSV's first row, as in the file [s]. @throws InputError as read_tool_path().
[[nodiscard]] double first_path_time(const std::filesystem::path& file);

/// [setup] Reads a path CSV (columns by header name). A path that begins before 0 s or after 10 s, as a log
/// with Unix time, is counted from its first row. @param remarks if given, receives a sentence when it is
/// so, and one when the times are probably not in seconds @param earliest the earliest first_path_time() of
/// several hands, which decides instead of the file's first row and is then the start of all their paths
/// @throws InputError that names file, line, column and value, also for times that cannot be in seconds and
/// positions beyond 100 m.
[[nodiscard]] ToolPath read_tool_path(const std::filesystem::path& file,
                                      PathInterpolation interpolation = PathInterpolation::kLinear,
                                      std::vector<std::string>* remarks = nullptr,
                                      std::optional<double> earliest = std::nullopt);

/// [setup] The path of a scripted device without a file, in the device's frame. The tool points down (+z
/// down) and starts above the organ's centre, with its lowest point 10 mm above the surface. In a press it
/// moves to a depth of 12 mm. In a pull it closes the jaws at the surface and lifts by 12 mm. Then it holds
/// for 1 s and returns. In task palpate it presses at the points of a grid over the organ's upper side. If a
/// single tool would slide off there, or start inside the organ, it presses along the normal of a flat region
/// instead (docs/model.md, section 4). Several hands are side by side, at most 30 mm apart. @throws
/// InputError when the organ's mesh is not closed.
[[nodiscard]] ToolPath default_path(const Scene& scene, std::size_t hand);

}  // namespace palpate::scene
