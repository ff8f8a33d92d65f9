#include "palpate/builtin.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/shapes/detail.h"
#include "io/shapes/forceps.h"
#include "io/shapes/gallbladder.h"
#include "io/shapes/heart.h"
#include "io/shapes/kidney.h"
#include "io/shapes/liver.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/units.h"

namespace palpate::geometry {

namespace {

constexpr std::string_view kSphere = "sphere:";
constexpr int kSphereTriangles = 1280;
constexpr double kBallRadius = 0.03;       // [m]
constexpr double kBoxEdge = 0.005;         // [m] longest edge of the box's squares
const Vec3 kBoxSize(0.060, 0.060, 0.040);  // [m]

TriangleMesh centred(TriangleMesh mesh) {
  const Vec3 middle = bounds(mesh).middle();
  for (Vec3& v : mesh.vertices) v -= middle;
  return mesh;
}

/// A shape's name without its ending, and what the ending says.
struct Name {
  std::string_view stem;
  Detail detail = Detail::kPaper;
};
Name split(std::string_view name) {
  constexpr std::string_view k30k = "-30k";
  constexpr std::string_view k300k = "-300k";
  if (name.ends_with(k30k)) return {name.substr(0, name.size() - k30k.size()), Detail::k30k};
  if (name.ends_with(k300k)) return {name.substr(0, name.size() - k300k.size()), Detail::k300k};
  return {name, Detail::kPaper};
}

[[noreturn]] void unknown(const std::string& kind, const std::string& name,
                          const std::vector<std::string>& names, const std::string& more) {
  const std::string near = nearest_word(name, names);
  throw InputError(fmt::format("unknown {} \"{}\"{} (built in: {}{}; a file needs a / or a known ending)",
                               kind, name, near.empty() ? "" : ", did you mean " + near + "?", joined(names),
                               more));
}

Tool sphere(const std::string& name) {
  const std::string_view number = std::string_view(name).substr(kSphere.size());
  double radius_mm = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), radius_mm);
  const bool whole = error == std::errc() && end == number.data() + number.size();
  constexpr double kLargest = 1000.0;  // mm
  if (!whole || !std::isfinite(radius_mm) || radius_mm <= 0.0 || radius_mm > kLargest) {
    throw InputError("tool \"" + name +
                     "\": the radius after \"sphere:\" must be a number of mm > 0 and <= 1000");
  }
  Tool tool;
  tool.name = name;
  tool.parts.push_back({.name = "ball", .mesh = make_ball(radius_mm * kMillimetre, kSphereTriangles)});
  return tool;
}

}  // namespace

const std::vector<std::string>& builtin_organ_names() {
  static const std::vector<std::string> names{"gallbladder",
                                              "heart",
                                              "liver",
                                              "kidney",
                                              "ball",
                                              "box",
                                              "gallbladder-30k",
                                              "heart-30k",
                                              "liver-30k",
                                              "kidney-30k",
                                              "gallbladder-300k",
                                              "heart-300k",
                                              "liver-300k",
                                              "kidney-300k"};
  return names;
}

TriangleMesh make_organ(const std::string& name) {
  const auto [stem, detail] = split(name);
  if (stem == "gallbladder") return centred(make_gallbladder(detail));
  if (stem == "heart") return centred(make_heart(detail));
  if (stem == "liver") return centred(make_liver(detail));
  if (stem == "kidney") return centred(make_kidney(detail));
  if (name == "ball") return centred(make_ball(kBallRadius));
  if (name == "box") return centred(make_box(kBoxSize, kBoxEdge));
  unknown("organ", name, builtin_organ_names(), "");
}

const std::vector<std::string>& builtin_tool_names() {
  static const std::vector<std::string> names{"curved-forceps",      "straight-forceps",
                                              "curved-forceps-30k",  "straight-forceps-30k",
                                              "curved-forceps-300k", "straight-forceps-300k"};
  return names;
}

Tool make_tool(const std::string& name) {
  const auto [stem, detail] = split(name);
  if (stem == "curved-forceps") return make_curved_forceps(detail);
  if (stem == "straight-forceps") return make_straight_forceps(detail);
  if (std::string_view(name).starts_with(kSphere)) return sphere(name);
  unknown("tool", name, builtin_tool_names(), ", sphere:R with R in mm");
}

}  // namespace palpate::geometry
