#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

enum Column : std::size_t { kTime, kX, kY, kZ, kQw, kQx, kQy, kQz, kGripper, kButtons };

constexpr double kAllButtons = 4294967295.0;  // 32 bits

const std::vector<CsvColumn> kColumns = {{"time_s"},         {"x_m"},           {"y_m"},       {"z_m"},
                                         {"qw", false},      {"qx", false},     {"qy", false}, {"qz", false},
                                         {"gripper", false}, {"buttons", false}};

/// Whether the path has rotations: all four components of a quaternion.
bool has_rotations(const CsvTable& table) {
  const bool any = table.has(kQw) || table.has(kQx) || table.has(kQy) || table.has(kQz);
  for (const std::size_t column : {kQw, kQx, kQy, kQz}) {
    if (any && !table.has(column)) {
      table.fail(kColumns[column].name + ": missing, must be all of qw, qx, qy, qz or none");
    }
  }
  return any;
}

Quat rotation(const CsvTable& table) {
  constexpr double kShortest = 1e-6;  // a shorter quaternion has no usable direction
  const Quat q(table.number(kQw), table.number(kQx), table.number(kQy), table.number(kQz));
  const double norm = q.norm();
  if (std::isfinite(norm) && norm > kShortest) {
    return {q.w() / norm, q.x() / norm, q.y() / norm, q.z() / norm};
  }
  table.fail(fmt::format("qw,qx,qy,qz = {},{},{},{}: must be a rotation, not of length {}", shortest(q.w()),
                         shortest(q.x()), shortest(q.y()), shortest(q.z()), shortest(norm)));
}

}  // namespace

ToolPath read_tool_path(const std::filesystem::path& file, PathInterpolation interpolation) {
  CsvTable table(file, kColumns);
  const bool turns = has_rotations(table);
  std::vector<PathRow> rows;
  while (table.next_row()) {
    PathRow row;
    row.time = table.number(kTime);
    row.position = {table.number(kX), table.number(kY), table.number(kZ)};
    if (turns) row.orientation = rotation(table);
    row.gripper = table.number(kGripper);
    if (row.gripper < 0.0 || row.gripper > 1.0) table.fail(kGripper, "must be 0 (closed) to 1 (open)");
    const double buttons = table.number(kButtons);
    if (!(buttons >= 0.0 && buttons <= kAllButtons && buttons == std::floor(buttons))) {
      table.fail(kButtons, "must be a whole number, the sum of 2^button over the pressed buttons");
    }
    row.buttons = static_cast<std::uint32_t>(buttons);
    if (!rows.empty() && row.time <= rows.back().time) {
      table.fail(kTime, "must be later than the row before, " + shortest(rows.back().time));
    }
    if (!rows.empty() && !std::isfinite(row.time - rows.front().time)) {
      table.fail(kTime,
                 "the path's length must be a finite number, it begins at " + shortest(rows.front().time));
    }
    rows.push_back(row);
  }
  return ToolPath(std::move(rows), table.has(kGripper), interpolation);
}

}  // namespace palpate::scene
