#include "tools/make_shapes/forceps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/portable_math.h"
#include "palpate/units.h"

#include "tools/make_shapes/haemostat.h"

namespace palpate::geometry {
namespace {

using portable::kPi;
using portable::sin_cos;

constexpr double kOpenAngle = 15.0 * kPi / 180.0;  // of each jaw
constexpr double kShaftRadius = 2.5;               // [mm], of the common 5 mm instrument
constexpr double kHingeRadius = 2.1;               // [mm] of the jaws' round plates

/// A cross-section of a jaw [mm]: half of a rounded bar, with its flat towards the other jaw.
struct Section {
  double along = 0.0;       // arc length of the centre line from the pivot
  double half_width = 0.0;  // across the flat
  double height = 0.0;      // of the back above the mid-plane between the jaws
  double gap = 0.09;        // of the flat from that mid-plane
  double turn_deg = 90.0;   // direction of the back: 0 along the hinge (y), 90 away from the other jaw (x)
  double square = 0.0;      // 0 round back .. 1 square
  double tooth = 0.0;       // offset of the flat, in the same direction for both jaws
};

/// The centre line of closed jaws: straight, then an arc towards -x.
struct CentreLine {
  double straight = 0.0;  // [mm]
  double bend = 0.0;      // curvature of the arc [1/mm]

  [[nodiscard]] Pose at(double along) const {
    const double arc = along - straight;
    if (bend <= 0.0 || arc <= 0.0) return {Quat::Identity(), Vec3(0.0, 0.0, along)};
    const portable::SinCos turn = sin_cos(bend * arc);
    return {rotation_about(Vec3::UnitY(), -bend * arc),
            Vec3(-(1.0 - turn.cosine) / bend, 0.0, straight + turn.sine / bend)};
  }
};

/// @param side +1 for the jaw on the +x side, -1 for the other: rotated by 180 degrees about the centre line
std::vector<Vec3> ring(const Section& s, const CentreLine& line, double side) {
  constexpr int kBack = 8;
  constexpr std::array<double, 4> kFlat{-0.85, -0.28, 0.28, 0.85};
  const portable::SinCos turn = sin_cos(s.turn_deg * kPi / 180.0);
  const Vec3 out = side * Vec3(turn.sine, turn.cosine, 0.0);
  const Vec3 across = side * Vec3(turn.cosine, -turn.sine, 0.0);
  const Pose here = line.at(s.along);
  const double edge = s.gap + 0.22 * (s.height - s.gap);  // height of the flat's bevelled edges
  std::vector<Vec3> points;
  for (int k = 0; k < kBack; ++k) {
    const portable::SinCos angle = sin_cos(kPi * k / (kBack - 1));
    const double to_square = 1.0 / std::max(std::abs(angle.cosine), angle.sine) - 1.0;
    const double swell = 1.0 + s.square * to_square;
    points.push_back(here * Vec3(s.half_width * swell * angle.cosine * across +
                                 (edge + (s.height - edge) * swell * angle.sine) * out));
  }
  for (const double share : kFlat) {
    points.push_back(here * Vec3(share * s.half_width * across + (s.gap + side * s.tooth) * out));
  }
  return points;
}

/// The hinge end of both kinds of jaws: a round plate beside the other one, then the flat turns from the
/// hinge's direction to the other jaw.
std::vector<Section> hinge_sections() {
  return {{-1.9, 0.9, 1.6, 0.12, 0.0, 0.8, 0.0},  {-1.3, 1.65, 1.6, 0.12, 0.0, 0.8, 0.0},
          {0.0, 2.1, 1.6, 0.12, 0.0, 0.8, 0.0},   {1.7, 1.9, 1.62, 0.12, 0.0, 0.8, 0.0},
          {2.7, 1.9, 1.8, 0.28, 25.0, 0.4, 0.0},  {3.6, 2.0, 2.0, 0.28, 60.0, 0.2, 0.0},
          {4.7, 2.15, 2.15, 0.09, 90.0, 0.0, 0.0}};
}

/// Rounds the end after its last section: a quarter of a ball over its half width.
void add_tip(std::vector<Section>& sections) {
  const Section end = sections.back();
  for (const double degrees : {32.0, 62.0}) {
    const portable::SinCos angle = sin_cos(degrees * kPi / 180.0);
    Section s = end;
    s.along += end.half_width * angle.sine;
    s.half_width *= angle.cosine;
    s.height = s.gap + (end.height - s.gap) * angle.cosine;
    sections.push_back(s);
  }
}

ToolPart jaw(const std::vector<Section>& sections, const CentreLine& line, double side) {
  std::vector<std::vector<Vec3>> rings;
  for (const Section& s : sections) rings.push_back(ring(s, line, side));
  const double tip = sections[sections.size() - 3].along + 0.98 * sections[sections.size() - 3].half_width;
  const Vec3 low_pole(0.0, side * 0.5 * (sections.front().gap + sections.front().height), -kHingeRadius);
  const Vec3 high_pole =
      line.at(tip) * Vec3(side * (sections.back().gap + 0.25 * sections.back().height), 0.0, 0.0);
  ToolPart part;
  part.name = side > 0.0 ? "left" : "right";
  part.mesh = loft(rings, low_pole, high_pole);
  for (Vec3& v : part.mesh.vertices) v *= kMillimetre;
  part.is_jaw = true;
  part.open_angle = side * kOpenAngle;
  return part;
}

/// The tube with the hinge, a fork of two cheeks beside the plates of the jaws.
class Shaft final {
 public:
  [[nodiscard]] ToolPart part() {
    tube();
    floor();
    cheek(2);
    cheek(10);
    ToolPart part;
    part.name = "shaft";
    part.mesh = std::move(mesh_);
    for (Vec3& v : part.mesh.vertices) v *= kMillimetre;
    return part;
  }

 private:
  static constexpr std::int32_t kAround = 16;
  static constexpr double kFloor = -3.2;  // start of the fork [mm]

  std::int32_t add(double x, double y, double z) {
    mesh_.vertices.emplace_back(x, y, z);
    return static_cast<std::int32_t>(mesh_.vertices.size()) - 1;
  }
  void triangle(std::int32_t a, std::int32_t b, std::int32_t c) { mesh_.triangles.push_back({a, b, c}); }
  static portable::SinCos angle(std::int32_t k) { return sin_cos(2.0 * kPi * (k % kAround) / kAround); }

  void tube() {
    struct Level {
      double z;
      double radius;
    };
    constexpr std::array<Level, 6> kLevels{{{-75.0, 2.2},
                                            {-74.6, kShaftRadius},
                                            {-50.0, kShaftRadius},
                                            {-25.0, kShaftRadius},
                                            {-9.0, kShaftRadius},
                                            {kFloor, kShaftRadius}}};
    const std::int32_t end = add(0.0, 0.0, kLevels.front().z);
    for (const Level& level : kLevels) {
      for (std::int32_t k = 0; k < kAround; ++k)
        add(level.radius * angle(k).cosine, level.radius * angle(k).sine, level.z);
    }
    rim_ = static_cast<std::int32_t>(mesh_.vertices.size()) - kAround;
    for (std::int32_t k = 0; k < kAround; ++k) triangle(end, 1 + (k + 1) % kAround, 1 + k);
    for (std::int32_t low = 1; low < rim_; low += kAround) {
      for (std::int32_t k = 0; k < kAround; ++k) {
        const std::int32_t next = (k + 1) % kAround;
        triangle(low + k, low + next, low + kAround + next);
        triangle(low + k, low + kAround + next, low + kAround + k);
      }
    }
  }

  /// The floor of the slot: a fan over the rim between the cheeks and the inner edges of the cheeks.
  void floor() {
    const std::int32_t middle = add(0.0, 0.0, kFloor);
    const double inner = kShaftRadius * angle(2).sine;
    feet_ = {add(0.0, inner, kFloor), add(0.0, -inner, kFloor)};
    const std::array<std::int32_t, 12> outline{rim_ + 0, rim_ + 1, rim_ + 2,  feet_[0], rim_ + 6,  rim_ + 7,
                                               rim_ + 8, rim_ + 9, rim_ + 10, feet_[1], rim_ + 14, rim_ + 15};
    for (std::size_t k = 0; k < outline.size(); ++k)
      triangle(middle, outline[k], outline[(k + 1) % outline.size()]);
  }

  /// A cheek on the rim's points first .. first + 4: extruded upwards, narrowed at the top, capped.
  void cheek(std::int32_t first) {
    struct Level {
      double z;
      double width;
    };
    constexpr std::array<Level, 4> kLevels{{{-1.4, 1.0}, {0.3, 1.0}, {1.05, 0.8}, {1.5, 0.42}}};
    std::array<std::int32_t, 6> low{rim_ + first,     rim_ + first + 1, rim_ + first + 2,
                                    rim_ + first + 3, rim_ + first + 4, feet_[first == 2 ? 0 : 1]};
    const std::array<std::int32_t, 6> base = low;
    for (const Level& level : kLevels) {
      std::array<std::int32_t, 6> high{};
      for (std::size_t k = 0; k < high.size(); ++k) {
        const Vec3 foot = mesh_.vertices[static_cast<std::size_t>(base[k])];
        high[k] = add(level.width * foot.x(), foot.y(), level.z);
      }
      for (std::size_t k = 0; k < high.size(); ++k) {
        const std::size_t next = (k + 1) % high.size();
        triangle(low[k], low[next], high[next]);
        triangle(low[k], high[next], high[k]);
      }
      low = high;
    }
    const double y = 0.5 * (mesh_.vertices[static_cast<std::size_t>(low[2])].y() +
                            mesh_.vertices[static_cast<std::size_t>(low[5])].y());
    const std::int32_t top = add(0.0, y, 1.65);
    for (std::size_t k = 0; k < low.size(); ++k) triangle(top, low[k], low[(k + 1) % low.size()]);
  }

  TriangleMesh mesh_;
  std::int32_t rim_ = 0;  // first vertex of the tube's upper end
  std::array<std::int32_t, 2> feet_{};
};

Tool assemble(const std::vector<Section>& sections, const CentreLine& line) {
  Tool tool;
  tool.parts = {jaw(sections, line, 1.0), jaw(sections, line, -1.0), Shaft().part()};
  return tool;
}

}  // namespace

Tool make_curved_forceps(Detail detail) {
  if (detail != Detail::kPaper) {
    const HaemostatShape shape{.straight = 5.5,
                               .bend = 0.033,
                               .jaw_length = 21.8,
                               .base_radius = 2.4,
                               .tip_radius = 1.7,
                               .open_angle = kOpenAngle};
    return make_haemostat(shape, detail);
  }
  std::vector<Section> sections = hinge_sections();
  constexpr std::array<double, 5> kAlong{8.0, 11.5, 15.0, 18.5, 21.8};
  for (std::size_t k = 0; k < kAlong.size(); ++k) {
    const double half = 2.1 - 0.1 * static_cast<double>(k);  // tapers to a tip of 1.7 mm radius
    sections.push_back({.along = kAlong[k], .half_width = half, .height = half});
  }
  add_tip(sections);
  return assemble(sections, {.straight = 5.5, .bend = 0.033});
}

Tool make_straight_forceps(Detail detail) {
  if (detail != Detail::kPaper) {
    const HaemostatShape shape{
        .jaw_length = 17.5, .base_radius = 2.4, .tip_radius = 2.0, .open_angle = kOpenAngle};
    return make_haemostat(shape, detail);
  }
  std::vector<Section> sections = hinge_sections();
  constexpr int kTeeth = 11;
  for (int k = 0; k < kTeeth; ++k) {
    const double tooth = k == 0 || k == kTeeth - 1 ? 0.0 : (k % 2 == 0 ? 0.22 : -0.22);
    const double half = 2.2 - 0.02 * k;  // tapers to a tip of 2 mm radius
    sections.push_back({.along = 6.0 + 1.15 * k, .half_width = half, .height = half, .tooth = tooth});
  }
  add_tip(sections);
  return assemble(sections, {.straight = 100.0});
}

TriangleMesh loft(const std::vector<std::vector<Vec3>>& rings, const Vec3& first_pole,
                  const Vec3& last_pole) {
  TriangleMesh mesh;
  for (const std::vector<Vec3>& ring : rings) {
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  }
  const auto around = static_cast<std::int32_t>(rings.front().size());
  const auto last = static_cast<std::int32_t>(mesh.vertices.size()) - around;
  for (std::int32_t low = 0; low < last; low += around) {
    for (std::int32_t k = 0; k < around; ++k) {
      const std::int32_t next = (k + 1) % around;
      mesh.triangles.push_back({low + k, low + next, low + around + next});
      mesh.triangles.push_back({low + k, low + around + next, low + around + k});
    }
  }
  const auto first_tip = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.push_back(first_pole);
  mesh.vertices.push_back(last_pole);
  for (std::int32_t k = 0; k < around; ++k) {
    const std::int32_t next = (k + 1) % around;
    mesh.triangles.push_back({first_tip, next, k});
    mesh.triangles.push_back({first_tip + 1, last + k, last + next});
  }
  return mesh;
}

}  // namespace palpate::geometry
