#include "palpate/builtin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/core.h>

#include "core/base/charconv.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/shapes/mesh_archive.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::geometry {

namespace {

constexpr std::string_view kSphere = "sphere:";
constexpr std::string_view kNeedle = "needle";
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

/// Outer diameters of needles by gauge [mm] (ISO 6009).
struct Gauge {
  int gauge;
  double diameter_mm;
};
constexpr std::array kGauges{Gauge{10, 3.4}, Gauge{11, 3.0}, Gauge{12, 2.7}, Gauge{13, 2.4}, Gauge{14, 2.1},
                             Gauge{15, 1.8}, Gauge{16, 1.6}, Gauge{17, 1.4}, Gauge{18, 1.2}, Gauge{19, 1.1},
                             Gauge{20, 0.9}, Gauge{21, 0.8}, Gauge{22, 0.7}, Gauge{23, 0.6}, Gauge{25, 0.5},
                             Gauge{27, 0.4}, Gauge{30, 0.3}};

/// A ring of a surface of revolution about z, in m; `shear` shifts its points along z by shear x.
struct Ring {
  double radius = 0.0;
  double z = 0.0;
  double shear = 0.0;
};

/// The closed surface around the rings, in order of z. The first and the last ring are closed by a point.
TriangleMesh around_z(const std::vector<Ring>& rings) {
  constexpr int kAround = 16;
  TriangleMesh mesh;
  for (const Ring& ring : rings) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * portable::kPi * i / kAround;
      const double x = ring.radius * std::cos(angle);
      mesh.vertices.emplace_back(x, ring.radius * std::sin(angle), ring.z + ring.shear * x);
    }
  }
  const auto index = [](std::size_t ring, int i) {
    return static_cast<std::int32_t>(ring * kAround) + i % kAround;
  };
  const auto bottom = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0, 0.0, rings.front().z);
  mesh.vertices.emplace_back(0.0, 0.0, rings.back().z);
  for (int i = 0; i < kAround; ++i) {
    mesh.triangles.push_back({bottom, index(0, i + 1), index(0, i)});
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
      mesh.triangles.push_back({index(r, i), index(r, i + 1), index(r + 1, i + 1)});
      mesh.triangles.push_back({index(r, i), index(r + 1, i + 1), index(r + 1, i)});
    }
    mesh.triangles.push_back({index(rings.size() - 1, i), index(rings.size() - 1, i + 1), bottom + 1});
  }
  return mesh;
}

[[noreturn]] void wrong_needle(const std::string& name, const std::string& part, const std::string& must) {
  throw InputError(fmt::format("tool \"{}\": {} {}: needle:SIZE,LENGTH_MM,TIP such as needle:18G,90,bevel",
                               name, part, must));
}

/// "18G", or a diameter in mm. [m]
double needle_diameter(const std::string& name, const std::string& size) {
  double number = 0.0;
  const bool gauge = !size.empty() && (size.back() == 'G' || size.back() == 'g');
  const char* const end = size.data() + size.size() - (gauge ? 1 : 0);
  const auto [read, error] = from_chars(size.data(), end, number);
  if (error == std::errc() && read == end) {
    if (!gauge && number >= 0.3 && number <= 3.4) return number * kMillimetre;
    for (const Gauge& known : kGauges) {
      if (gauge && known.gauge == number) return known.diameter_mm * kMillimetre;
    }
  }
  std::string gauges;
  for (const Gauge& known : kGauges) gauges += (gauges.empty() ? "" : ", ") + std::to_string(known.gauge);
  wrong_needle(name, "\"" + size + "\"",
               "must be a diameter of 0.3 to 3.4 mm, or a gauge: " + gauges + " and a G");
}

/// needle, needle:SIZE, needle:SIZE,LENGTH_MM or needle:SIZE,LENGTH_MM,TIP: shaft and hub.
Tool needle(const std::string& name) {
  std::array<std::string, 3> parts{"18G", "90", "bevel"};
  std::string rest = name.size() > kNeedle.size() ? name.substr(kNeedle.size() + 1) : "";
  for (std::size_t i = 0; !rest.empty(); ++i) {
    if (i == parts.size()) wrong_needle(name, "\"" + rest + "\"", "is one part too many");
    const std::size_t comma = rest.find(',');
    parts[i] = rest.substr(0, comma);
    rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
  }
  const double diameter = needle_diameter(name, parts[0]);
  double length_mm = 0.0;
  const char* const end = parts[1].data() + parts[1].size();
  const auto [read, error] = from_chars(parts[1].data(), end, length_mm);
  if (error != std::errc() || read != end || !(length_mm >= 10.0 && length_mm <= 300.0)) {
    wrong_needle(name, "the length \"" + parts[1] + "\"", "must be 10 to 300 mm");
  }
  const double r = diameter / 2.0;
  const double length = length_mm * kMillimetre;
  std::vector<Ring> rings{{3e-3, -22e-3}, {4e-3, -20e-3}, {4e-3, -8e-3}, {2.5e-3, -1e-3}, {r, 0.0}};
  for (double z = 2e-3; z < length - 6.0 * r; z += 4e-3) rings.push_back({r, z});
  if (parts[2] == "bevel") {
    constexpr double kCotangent = 2.75;  // of 20 degrees
    rings.push_back({r, length - r * kCotangent, kCotangent});
  } else if (parts[2] == "pencil") {
    rings.insert(rings.end(), {{r, length - 5.0 * r}, {0.7 * r, length - 2.0 * r}, {0.15 * r, length}});
  } else if (parts[2] == "tuohy") {
    constexpr double kCotangent = 1.2;  // a blunt, curved end
    rings.insert(rings.end(), {{r, length - 4.0 * r}, {0.8 * r, length - 0.96 * r, kCotangent}});
  } else {
    wrong_needle(name, "the tip \"" + parts[2] + "\"", "must be bevel, pencil or tuohy");
  }
  Tool tool;
  tool.name = name;
  tool.parts.push_back({.name = "needle", .mesh = around_z(rings)});
  tool.needle = Needle{Vec3(0.0, 0.0, length), Vec3::UnitZ(), diameter, length};
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
      with_endings({"curved-forceps", "straight-forceps"}, {std::string(kNeedle)}, "/left");
  return names;
}

Tool make_tool(const std::string& name) {
  if (std::string_view(name).starts_with(kSphere)) return sphere(name);
  if (name == kNeedle || name.starts_with("needle:")) return needle(name);
  if (!contains(builtin_tool_names(), name)) {
    unknown("tool", name, builtin_tool_names(), ", sphere:R with R in mm, needle:SIZE,LENGTH_MM,TIP");
  }
  return forceps(name);
}

}  // namespace palpate::geometry
