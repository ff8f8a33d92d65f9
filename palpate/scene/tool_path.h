#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/base/pose.h"
#include "palpate/scene/setup.h"

namespace palpate::scene {

/// One row of a tool path.
struct PathRow {
  double time = 0.0;  // s
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double gripper = 0.0;
};

/// A path in time: positions linear, rotations slerped between rows; the pose holds before the first and
/// after the last row.
class ToolPath final {
 public:
  /// [setup] @throws InputError when there is no row or times do not strictly increase.
  explicit ToolPath(std::vector<PathRow> rows, bool has_gripper = true);

  /// [rt] The row at `time` [s].
  [[nodiscard]] PathRow at(double time) const noexcept;
  [[nodiscard]] double end_time() const noexcept { return rows_.back().time; }
  [[nodiscard]] bool has_gripper() const noexcept { return has_gripper_; }
  [[nodiscard]] const std::vector<PathRow>& rows() const noexcept { return rows_; }

 private:
  std::vector<PathRow> rows_;
  bool has_gripper_;
};

/// [setup] Reads a path CSV (columns by header name). @throws InputError naming file, line, column and value.
[[nodiscard]] ToolPath read_tool_path(const std::filesystem::path& file);

/// [setup] The path that a scripted device without a file takes: from above the organ's middle, tool +z down,
/// 10 mm clear, to 12 mm of depth or pull, hold 1 s, back. In the device's frame (the mapping of `setup` is
/// undone).
[[nodiscard]] ToolPath default_path(const Setup& setup, std::size_t hand);

}  // namespace palpate::scene
