#include "io/scene/instrument.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "core/base/rotation.h"
#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/scene/plausibility.h"
#include "io/system/path_text.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr std::string_view kSpherePrefix = "sphere:";
constexpr double kShaftShare = 0.9;  // of a needle's length, where its mesh must be about as wide as it says
constexpr double kMostWidth = 1.5;   // factor between the two
constexpr double kRounding = 1e-6;

geometry::Tool make_sphere(const LocatedString& mesh) {
  geometry::Tool tool = with_location(mesh, [&mesh] { return geometry::make_tool(mesh.value); });
  tool.tip_radius = tool.parts.front().mesh.vertices.front().norm();  // all vertices are on the sphere
  return tool;
}

geometry::ToolPart read_part(const LocatedString& mesh, const std::optional<LengthUnit>& unit,
                             MeshNotes& notes) {
  geometry::ToolPart part;
  part.name = to_text(to_path(mesh.value).stem());
  mesh_io::LoadedMesh loaded = read_part_source(mesh, unit, notes);
  if (!loaded.findings.closed) {
    notes.remarks.push_back(mesh.value + ": not closed, used as it is (a tool need not be closed)");
  }
  part.mesh = std::move(loaded.mesh);
  return part;
}

geometry::Tool read_main_mesh(const ToolTable& description, MeshNotes& notes) {
  const LocatedString& mesh = *description.mesh;
  if (mesh.value.starts_with(kSpherePrefix)) return make_sphere(mesh);
  geometry::Tool tool;
  if (is_path(mesh.value)) {
    tool.parts.push_back(read_part(mesh, description.unit, notes));
    return tool;
  }
  if (mesh.value.starts_with("needle:"))
    return with_location(mesh, [&mesh] { return geometry::make_tool(mesh.value); });
  const std::vector<std::string>& known = geometry::builtin_tool_names();
  if (std::find(known.begin(), known.end(), mesh.value) == known.end()) {
    mesh.fail("must be " + alternatives(known) +
              ", sphere:R, needle:SIZE,LENGTH_MM,TIP, or a file (with a / or an extension such as .stl)");
  }
  return geometry::make_tool(mesh.value);
}

/// Centroid of a surface by area; mean of its vertices if the area is 0.
Vec3 middle(const geometry::TriangleMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const double doubled = geometry::area_vector_doubled(mesh, t).norm();
    for (const std::int32_t corner : t)
      sum += doubled / 3.0 * mesh.vertices[static_cast<std::size_t>(corner)];
    area += doubled;
  }
  return area > 0.0 ? Vec3(sum / area) : geometry::bounds(mesh).middle();
}

/// Extents [m] of the vertices that are at least `from` along an axis: along it, and across it.
struct Extents {
  geometry::Bounds box;  // z along the axis
  std::size_t count = 0;
};
Extents extents_of(const geometry::TriangleMesh& mesh, const Quat& to_axis, double from) {
  Extents found;
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 point = to_axis * vertex;
    if (point.z() < from) continue;
    found.box.low = found.count == 0 ? point : Vec3(found.box.low.cwiseMin(point));
    found.box.high = found.count == 0 ? point : Vec3(found.box.high.cwiseMax(point));
    ++found.count;
  }
  return found;
}

/// The needle that a mesh is. The tip is its foremost point, in the middle of the shaft.
geometry::Needle needle_of(const ToolTable& description, const geometry::Tool& tool) {
  const NeedleTable& table = *description.needle;
  const auto fail = [&table](const std::string& key, const std::string& why) {
    throw InputError(table.where + key + ": " + why);
  };
  if (!description.mesh || tool.parts.size() != 1 || tool.needle || tool.tip_radius) {
    fail("", "needs a tool of one mesh file, tool.mesh");
  }
  const geometry::TriangleMesh& mesh = tool.parts.front().mesh;
  const Quat to_axis = rotation_between(table.axis, Vec3::UnitZ());
  const geometry::Bounds whole = extents_of(mesh, to_axis, -std::numeric_limits<double>::infinity()).box;
  const double long_by = whole.high.z() - whole.low.z();
  const auto in_mm = [](double length) { return brief(length / kMillimetre, 3) + " mm"; };
  if (table.length > long_by * (1.0 + kRounding)) {
    fail(".length_mm", in_mm(table.length) + " is more than the mesh has along the axis, " + in_mm(long_by));
  }
  const Extents shaft = extents_of(mesh, to_axis, whole.high.z() - kShaftShare * table.length);
  const Vec3 size = shaft.box.high - shaft.box.low;
  const double width = std::max(size.x(), size.y());
  if (width > kMostWidth * table.diameter || (shaft.count > 2 && width < table.diameter / kMostWidth)) {
    fail(".diameter_mm", in_mm(table.diameter) + ", but the mesh is " + in_mm(width) + " wide within " +
                             in_mm(kShaftShare * table.length) + " of its tip");
  }
  Vec3 tip = (shaft.box.low + shaft.box.high) / 2.0;
  tip.z() = whole.high.z();
  return {to_axis.conjugate() * tip, table.axis, table.diameter, table.length};
}

std::string names_of(const ToolTable& description) {
  std::string name = description.mesh ? description.mesh->value : "";
  for (const JawTable& jaw : description.jaws) name += (name.empty() ? "" : " + ") + jaw.mesh.value;
  return name;
}

}  // namespace

void open_apart(std::vector<geometry::ToolPart>& jaws) {
  if (jaws.size() < 2) return;
  std::vector<Vec3> middles;
  Vec3 sum = Vec3::Zero();
  for (const geometry::ToolPart& jaw : jaws) {
    middles.push_back(middle(jaw.mesh));
    sum += middles.back();
  }
  const double others = static_cast<double>(jaws.size()) - 1.0;
  Vec3 spread = Vec3::Zero();
  for (const Vec3& m : middles) spread += (m - (sum - m) / others).cwiseAbs();
  const Vec3 axis = spread.y() > spread.x() ? Vec3::UnitX() : Vec3::UnitY();
  for (std::size_t i = 0; i < jaws.size(); ++i) {
    geometry::ToolPart& jaw = jaws[i];
    jaw.axis = axis;
    const Vec3 away = middles[i] - (sum - middles[i]) / others;
    const double side = axis.cross(middles[i] - jaw.pivot).dot(away);
    if (side < 0.0) jaw.open_angle = -jaw.open_angle;
  }
}

geometry::Tool load_instrument(const ToolTable& description, MeshNotes& notes) {
  geometry::Tool tool;
  if (description.mesh) tool = read_main_mesh(description, notes);
  if (description.needle) tool.needle = needle_of(description, tool);
  std::vector<geometry::ToolPart> jaws;
  for (const JawTable& jaw : description.jaws) {
    if (!is_path(jaw.mesh.value)) jaw.mesh.fail("must be a file (with a / or an extension such as .stl)");
    geometry::ToolPart part = read_part(jaw.mesh, description.unit, notes);
    part.is_jaw = true;
    part.pivot = jaw.pivot;
    part.axis = jaw.axis;
    part.open_angle = jaw.open_angle;
    jaws.push_back(std::move(part));
  }
  if (description.jaws_by_flags) open_apart(jaws);
  for (geometry::ToolPart& jaw : jaws) tool.parts.push_back(std::move(jaw));
  if (tool.parts.size() > kMaxParts) {
    const LocatedString& last = description.jaws.empty() ? *description.mesh : description.jaws.back().mesh;
    last.fail(fmt::format("the tool has {} parts, must be at most {}", tool.parts.size(), kMaxParts));
  }
  const auto note = [&notes](std::string remark) {
    if (!remark.empty()) notes.remarks.push_back(std::move(remark));
  };
  std::vector<const LocatedString*> files;  // of the last parts
  if (description.mesh && is_path(description.mesh->value)) files.push_back(&*description.mesh);
  for (const JawTable& jaw : description.jaws) files.push_back(&jaw.mesh);
  const std::span<const geometry::ToolPart> parts = std::span(tool.parts).last(files.size());
  if (!files.empty()) {
    const std::string whole = tool_size_remark(parts, *files[0]);
    note(whole);
    if (whole.empty()) {
      for (std::size_t i = 0; i < parts.size(); ++i) note(part_size_remark(parts[i], *files[i]));
    }
  }
  if (tool.tip_radius) note(tool_size_remark(std::span(tool.parts).first(1), *description.mesh));  // a ball
  for (geometry::ToolPart& part : tool.parts) {
    geometry::transform(part.mesh, description.mount);
    part.pivot = description.mount * part.pivot;
    part.axis = description.mount.rotation * part.axis;
  }
  if (tool.needle) {
    tool.needle->tip = description.mount * tool.needle->tip;
    tool.needle->axis = description.mount.rotation * tool.needle->axis;
  }
  if (!files.empty()) note(tool_distance_remark(parts, *files[0]));
  tool.name = names_of(description);
  if (description.tip_radius) tool.tip_radius = description.tip_radius;
  return tool;
}

}  // namespace palpate::scene
