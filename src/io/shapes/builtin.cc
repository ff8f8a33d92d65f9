#include "palpate/builtin.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/core.h>

#include "core/base/charconv.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/shapes/mesh_archive.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/units.h"

namespace palpate::geometry {

namespace {

constexpr std::string_view kSphere = "sphere:";
constexpr int kSphereTriangles = 1280;
constexpr double kBallRadius = 0.03;       // [m]
constexpr double kBoxEdge = 0.005;         // [m] longest edge of the squares on the box
const Vec3 kBoxSize(0.060, 0.060, 0.040);  // [m]

/// The names `stems`, then `more`, then all `stems` with each resolution's suffix that the archive has
/// (`part` is the end of a mesh's name).
std::vector<std::string> with_endings(const std::vector<std::string>& stems,
                                      const std::vector<std::string>& more, const std::string& part = "") {
  std::vector<std::string> names = stems;
  names.insert(names.end(), more.begin(), more.end());
  for (const char* ending : {"-30k", "-300k"}) {
    for (const std::string& stem : stems) {
      if (has_mesh(built_in_meshes(), stem + ending + part)) names.push_back(stem + ending);
    }
  }
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

[[noreturn]] void unknown(const std::string& kind, const std::string& name,
                          const std::vector<std::string>& names, const std::string& more) {
  const std::string near = nearest_word(name, names);
  throw InputError(fmt::format("unknown {} \"{}\"{} (built in: {}{}; a file needs a / or a known extension)",
                               kind, name, near.empty() ? "" : ", did you mean " + near + "?", joined(names),
                               more));
}

Tool sphere(const std::string& name) {
  const std::string_view number = std::string_view(name).substr(kSphere.size());
  double radius_mm = 0.0;
  const auto [end, error] = from_chars(number.data(), number.data() + number.size(), radius_mm);
  const bool whole = error == std::errc() && end == number.data() + number.size();
  constexpr double kLargest = 200.0;  // mm: no hand holds a larger ball
  if (!whole || !std::isfinite(radius_mm) || radius_mm <= 0.0 || radius_mm > kLargest) {
    throw InputError("tool \"" + name +
                     "\": the radius after \"sphere:\" must be a number of mm > 0 and <= 200");
  }
  Tool tool;
  tool.name = name;
  tool.parts.push_back({.name = "ball", .mesh = make_ball(radius_mm * kMillimetre, kSphereTriangles)});
  return tool;
}

/// Two jaws and the shaft, for both kinds of forceps.
Tool forceps(const std::string& name) {
  constexpr double kOpenAngle = 15.0 * portable::kPi / 180.0;  // [rad] of each jaw at gripper 1
  const std::string ending = name.substr(name.find("forceps") + std::string_view("forceps").size());
  const auto mesh = [](const std::string& part) { return unpack_mesh(built_in_meshes(), part); };
  Tool tool;
  tool.name = name;
  tool.parts.push_back(
      {.name = "left", .mesh = mesh(name + "/left"), .is_jaw = true, .open_angle = kOpenAngle});
  tool.parts.push_back(
      {.name = "right", .mesh = mesh(name + "/right"), .is_jaw = true, .open_angle = -kOpenAngle});
  tool.parts.push_back({.name = "shaft", .mesh = mesh("shaft" + ending)});
  return tool;
}

}  // namespace

const std::vector<std::string>& builtin_organ_names() {
  static const std::vector<std::string> names =
      with_endings({"gallbladder", "heart", "liver", "kidney"}, {"ball", "box"});
  return names;
}

TriangleMesh make_organ(const std::string& name) {
  if (name == "ball") return make_ball(kBallRadius);
  if (name == "box") return make_box(kBoxSize, kBoxEdge);
  if (!contains(builtin_organ_names(), name)) unknown("organ", name, builtin_organ_names(), "");
  return unpack_mesh(built_in_meshes(), name);
}

const std::vector<std::string>& builtin_tool_names() {
  static const std::vector<std::string> names =
      with_endings({"curved-forceps", "straight-forceps"}, {}, "/left");
  return names;
}

Tool make_tool(const std::string& name) {
  if (std::string_view(name).starts_with(kSphere)) return sphere(name);
  if (!contains(builtin_tool_names(), name))
    unknown("tool", name, builtin_tool_names(), ", sphere:R with R in mm");
  return forceps(name);
}

}  // namespace palpate::geometry
