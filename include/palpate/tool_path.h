#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/pose.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// One row of a tool path.
struct PathRow {
  double time = 0.0;  // s
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double gripper = 0.0;
};

/// A path in time: positions by PathInterpolation, rotations slerped between rows, the gripper linear; the
/// pose holds before the first and after the last row.
class ToolPath final {
 public:
  /// [setup] Orientations must be unit quaternions. @throws InputError when there is no row or times do not
  /// strictly increase.
  explicit ToolPath(std::vector<PathRow> rows, bool has_gripper = true,
                    PathInterpolation interpolation = PathInterpolation::kLinear);

  /// [rt] The row at `time` [s].
  [[nodiscard]] PathRow at(double time) const noexcept;
  /// [rt] Velocity [m/s] at `time` [s]; at a corner that of the piece that begins there, 0 outside the path.
  [[nodiscard]] Vec3 velocity_at(double time) const noexcept;
  [[nodiscard]] double end_time() const noexcept { return rows_.back().time; }
  [[nodiscard]] bool has_gripper() const noexcept { return has_gripper_; }
  [[nodiscard]] const std::vector<PathRow>& rows() const noexcept { return rows_; }

 private:
  /// Index of the last row at or before `time`, which is not before the first row's.
  [[nodiscard]] std::size_t row_before(double time) const noexcept;

  std::vector<PathRow> rows_;
  std::vector<Vec3> slopes_;      // m/s, at each row; empty: linear
  double rows_per_second_ = 0.0;  // on average; 0 with one row
  bool has_gripper_;
};

/// [setup] Reads a path CSV (columns by header name). @throws InputError naming file, line, column and value.
[[nodiscard]] ToolPath read_tool_path(const std::filesystem::path& file,
                                      PathInterpolation interpolation = PathInterpolation::kLinear);

/// [setup] The path that a scripted device without a file takes: tool +z down, from above the organ's middle
/// with the tool's lowest point 10 mm clear, to 12 mm of depth (press) or, closed at touch, 12 mm of lift
/// (pull), hold 1 s, back. Where a single tool's press from there would slide off, or start inside, it goes
/// along the normal to a flat place instead (docs/model.md, section 4). Several hands stand side by side,
/// 30 mm apart at most. In the device's frame (the mapping of `setup` is undone).
/// @throws InputError when the organ's mesh is not closed.
[[nodiscard]] ToolPath default_path(const Setup& setup, std::size_t hand);

}  // namespace palpate::scene
