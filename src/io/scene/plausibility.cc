#include "io/scene/plausibility.h"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/plausible.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

void widen(geometry::Bounds& box, const Vec3& point, bool first) {
  box.low = first ? point : Vec3(box.low.cwiseMin(point));
  box.high = first ? point : Vec3(box.high.cwiseMax(point));
}

geometry::Bounds box_of(std::span<const geometry::ToolPart> parts) {
  geometry::Bounds box;
  bool first = true;
  for (const geometry::ToolPart& part : parts) {
    for (const Vec3& vertex : part.mesh.vertices) {
      widen(box, vertex, first);
      first = false;
    }
  }
  return box;
}

double distance_from_origin(const geometry::Bounds& box) {
  return box.low.cwiseMax(-box.high).cwiseMax(0.0).norm();
}

/// Box in the world of the handle's positions. @param scale of the file's unit, 1 for metres
geometry::Bounds handle_box(const DeviceSetup& device, const geometry::Bounds& positions_D, double scale) {
  geometry::Bounds box;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto side = [&](unsigned axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      return (corner >> axis & 1U) != 0 ? positions_D.high[i] : positions_D.low[i];
    };
    const Vec3 position(side(0), side(1), side(2));
    widen(box, device.base * Vec3(device.workspace_scale * scale * position), corner == 0);
  }
  return box;
}

double distance_between(const geometry::Bounds& a, const geometry::Bounds& b) {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

/// Largest distance of a closed tool's surface from the origin of the handle [m].
double reach_of(const geometry::Tool& tool) {
  double reach = 0.0;
  for (const geometry::ToolPart& part : tool.parts) {
    for (const Vec3& vertex : part.mesh.vertices) reach = std::max(reach, vertex.norm());
  }
  return reach;
}

std::string size_question(std::string_view who, double size) {
  return fmt::format("{}'s largest side is {}, usual is 1 to 1000 mm{}", who, in_unit(kToolExtent, size),
                     unit_question(kToolExtent, size));
}

}  // namespace

geometry::Bounds organ_box(const Scene& scene) {
  geometry::TriangleMesh placed = scene.organ;
  geometry::transform(placed, scene.organ_pose);
  return geometry::bounds(placed);
}

std::string tool_size_remark(std::span<const geometry::ToolPart> parts, const LocatedString& where) {
  const double size = box_of(parts).size().maxCoeff();
  if (kToolExtent.usual.contains(size)) return {};
  const std::string what = size_question("the instrument", size);
  if (!kToolExtent.possible.contains(size)) where.fail(what);
  return where.value + ": " + what;
}

std::string part_size_remark(const geometry::ToolPart& part, const LocatedString& where) {
  const double size = box_of(std::span(&part, 1)).size().maxCoeff();
  if (kToolExtent.usual.contains(size)) return {};
  return where.value + ": " + size_question("the part", size);
}

std::string tool_distance_remark(std::span<const geometry::ToolPart> parts, const LocatedString& where) {
  const double distance = distance_from_origin(box_of(parts));
  if (kToolDistance.usual.contains(distance)) return {};
  const std::string what =
      fmt::format("the instrument lies {} from the origin of its file, which is its handle",
                  in_unit(kToolDistance, distance));
  if (!kToolDistance.possible.contains(distance)) {
    where.fail(what + ": move it to the origin, in a mesh tool or by tool.mount");
  }
  return where.value + ": " + what + ": is that where the handle should be? (tool.mount moves it)";
}

std::string organ_distance_remark(const geometry::Bounds& organ_W, const std::string& where) {
  const double distance = distance_from_origin(organ_W);
  if (kOrganDistance.usual.contains(distance)) return {};
  const auto axis = [&organ_W](Eigen::Index i) {
    return fmt::format("{} to {}", brief(organ_W.low[i], 6), brief(organ_W.high[i], 6));
  };
  const std::string what = fmt::format("the organ lies {:.4g} m from the origin, at x {}, y {}, z {} m",
                                       distance, axis(0), axis(1), axis(2));
  if (!kOrganDistance.possible.contains(distance)) {
    throw InputError(fmt::format(
        "{}: {}: must be within {} m, where devices reach: move it, in a mesh tool or by organ.pose", where,
        what, shortest(kOrganDistance.possible.high)));
  }
  return fmt::format("{}: is that where it should be? Poses of tools count from the origin too", what);
}

std::vector<std::string> tissue_remarks(const model::TissueParameters& tissue) {
  std::vector<std::string> remarks;
  const std::string who = "tissue '" + tissue.name + "': ";
  if (!kPlausibleStiffness.usual.contains(tissue.k1)) {
    remarks.push_back(fmt::format("{}k1_N_per_m = {}, usual is {} to {}{}", who, brief(tissue.k1),
                                  brief(kPlausibleStiffness.usual.low), brief(kPlausibleStiffness.usual.high),
                                  column_question(kPlausibleStiffness, tissue.k1, "k1_N_per_m", 1.0)));
  }
  const double limit = tissue.rest_length - tissue.min_length;
  if (!kDepthRange.usual.contains(limit)) {
    remarks.push_back(fmt::format("{}rest_length_mm - min_length_mm = {}, usual is {} to {}{}", who,
                                  brief(limit / kMillimetre), brief(kDepthRange.usual.low / kMillimetre),
                                  brief(kDepthRange.usual.high / kMillimetre),
                                  column_question(kDepthRange, limit, "rest_length_mm", kMillimetre)));
  }
  return remarks;
}

PathSummary summary_of(const ToolPath& path) {
  constexpr std::size_t kFewest = 8;  // rows of a log (docs/decisions/0031-cubic-paths.md)
  constexpr double kFast = 200.0;     // Hz: linear interpolation suffices
  const std::vector<PathRow>& rows = path.rows();
  PathSummary summary;
  for (const PathRow& row : rows) widen(summary.positions_D, row.position, &row == rows.data());
  const double length = rows.back().time - rows.front().time;
  summary.is_sampled = rows.size() >= kFewest && static_cast<double>(rows.size() - 1) < kFast * length;
  return summary;
}

std::string far_path_remark(const Scene& scene, const geometry::Bounds& organ_W, std::size_t hand,
                            const PathSummary& path) {
  const DeviceSetup& device = scene.devices[hand];
  const double reach = reach_of(scene.tools[hand]);
  const auto gap = [&](double scale) {
    return std::max(0.0, distance_between(organ_W, handle_box(device, path.positions_D, scale)) - reach);
  };
  const double distance = gap(1.0);
  if (kPathDistance.usual.contains(distance)) return {};
  std::vector<std::string> units;  // in which the path moves and comes near
  for (const NamedUnit& unit : kPathDistance.others) {
    constexpr double kNear = 0.05;   // m
    constexpr double kMoves = 1e-3;  // m
    const bool moves = unit.si * path.positions_D.size().maxCoeff() >= kMoves;
    if (moves && gap(unit.si) <= kNear) units.emplace_back(unit.name);
  }
  const std::string question = units.empty()
                                   ? "are its positions in metres, in the organ's frame?"
                                   : fmt::format("are x_m, y_m and z_m in {}?", joined(units, " or "));
  return fmt::format("device {}: {}: the tool comes no nearer to the organ than {}: {}", device.kind,
                     device.path, in_unit(kPathDistance, distance), question);
}

}  // namespace palpate::scene
