#include "tools/make_shapes/haemostat.h"

#include <vector>

#include "core/base/portable_math.h"
#include "palpate/units.h"

#include "tools/make_shapes/field_arithmetic.h"
#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/remesh.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

namespace {

using portable::kPi;

// All lengths are in millimetres until meshing.
constexpr double kPlate = 1.5;                 // half thickness of the two hinge plates of the jaws together
constexpr double kHaemostatHingeRadius = 2.5;  // of the plates
constexpr double kSlot = 1.75;                 // half width of the slot in the box
constexpr double kSlotFloor = -3.0;            // end of the slot
constexpr double kGap = 0.1;                   // half gap between the closed jaws
constexpr double kHaemostatFar = 6.0;          // larger than all blends

/// |a| <= half, as a solid.
FieldValue slab(const FieldValue& a, double half) { return magnitude(a) + (-half); }

/// One jaw: half of a round tapering bar and of a round hinge plate, with ribs across. The cutting surface
/// turns from the hinge's direction to the other jaw.
class Jaw final : public ImplicitSolid {
 public:
  /// @param side +1 for the jaw on the +x side, -1 for the other
  Jaw(const HaemostatShape& shape, double side)
      : shape_(shape), side_(side), bar_(bar(shape), kHaemostatFar) {}

  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ());
    FieldValue across = x;  // from the centre line, in the plane of the jaws' rotation
    FieldValue along = z;
    if (shape_.bend > 0.0 && z.value > shape_.straight) {
      const double radius = 1.0 / shape_.bend;
      const FieldValue from_centre = x + radius;
      const FieldValue ahead = z + (-shape_.straight);
      across = length_of(from_centre, ahead) + (-radius);
      along = radius * angle_of(from_centre, ahead) + shape_.straight;
    }
    const FieldValue plate = intersect(length_of(x, z) + (-kHaemostatHingeRadius), slab(y, kPlate), 0.6);
    const FieldValue both = unite(plate, bar_.at(p), 1.5);
    const SinCosField turn = sin_cos_of(0.5 * kPi * rise(along, 2.2, 6.5));
    const FieldValue off = turn.sine * across + turn.cosine * y;
    const double pitch = 2.0 * kPi / shape_.rib_pitch;
    const FieldValue ribbed = rise(along, 6.0, 7.5);
    const FieldValue ribs = shape_.rib_height * ribbed * sin_cos_of(pitch * along).sine;
    const FieldValue own = (-side_) * off + kGap + side_ * ribs;
    const FieldValue all = intersect(both, 0.8 * own, 0.35);
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  static std::vector<TubeKnot> bar(const HaemostatShape& shape) {
    constexpr int kKnots = 9;
    constexpr double kStart = 3.2;
    std::vector<TubeKnot> knots{{{0.0, 0.0, kStart}, 1.45}};
    for (int k = 0; k < kKnots; ++k) {
      const double share = static_cast<double>(k) / (kKnots - 1);
      constexpr double kFull = 5.5;
      const double along = kFull + share * (shape.jaw_length - kFull);
      const double radius = shape.base_radius + share * (shape.tip_radius - shape.base_radius);
      const double arc = along - shape.straight;
      if (shape.bend <= 0.0 || arc <= 0.0) {
        knots.push_back({{0.0, 0.0, along}, radius});
        continue;
      }
      const portable::SinCos turn = portable::sin_cos(shape.bend * arc);
      knots.push_back(
          {{-(1.0 - turn.cosine) / shape.bend, 0.0, shape.straight + turn.sine / shape.bend}, radius});
    }
    return knots;
  }

  HaemostatShape shape_;
  double side_;
  Tube bar_;
};

/// Box joint, shanks, ratchet and finger rings.
class Handles final : public ImplicitSolid {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    // One half is the other one, rotated by 180 degrees about the z axis.
    const Vec3 turned(-p.x(), -p.y(), p.z());
    FieldValue other = half(turned);
    other.gradient = Vec3(-other.gradient.x(), -other.gradient.y(), other.gradient.z());
    FieldValue all = unite(half(p), other, p.z() > -40.0 ? 2.5 : 0.0);
    if (p.z() > -kBoxReach) all = unite(all, box(p), 3.0);
    if (p.z() > -kBoxReach) all = subtract(all, slot(p), 0.5);
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  static constexpr double kBoxReach = 20.0;
  static constexpr double kRingX = 13.2;
  static constexpr double kRingZ = -101.0;

  /// A block with rounded edges and a domed pin head on each side.
  [[nodiscard]] static FieldValue box(const Vec3& p) {
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ()) + 2.6;
    FieldValue block = intersect(slab(x, 3.7), slab(z, 6.0), 2.6);
    block = intersect(block, slab(y, 3.1), 1.1);
    const FieldValue pin = intersect(length_of(x, z + (-2.6)) + (-1.75), slab(y, 3.5), 0.7);
    return unite(block, pin, 0.35);
  }

  /// Between the two cheeks: open in front and at both sides.
  [[nodiscard]] static FieldValue slot(const Vec3& p) {
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ());
    return intersect(slab(y, kSlot), -z + kSlotFloor, 0.8);
  }

  /// Shank, ring and ratchet arm on the +x side.
  [[nodiscard]] FieldValue half(const Vec3& p) const {
    FieldValue all = shank_.at(p);
    constexpr double kRingReach = -76.0;
    if (p.z() > kRingReach) return all;
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ());
    constexpr double kRing = 10.3;   // radius of its centre line, across
    constexpr double kLonger = 0.8;  // smaller curvature along the ring
    constexpr double kWire = 2.3;
    const FieldValue out = length_of(x + (-kRingX), kLonger * (z + (-kRingZ))) + (-kRing);
    all = unite(all, length_of(out, 0.85 * y) + (-kWire), 3.5);
    return unite(all, arm(x, y, z), 2.2);
  }

  /// Half of the ratchet: a bar towards the other shank, with three teeth towards the other bar.
  [[nodiscard]] static FieldValue arm(const FieldValue& x, const FieldValue& y, const FieldValue& z) {
    constexpr double kMiddle = -84.0;
    constexpr double kPitch = 2.1;
    const FieldValue toothed = rise(x, -2.4, -1.7) * rise(-x, -2.4, -1.7);
    const FieldValue teeth = 0.28 * toothed * sin_cos_of(2.0 * kPi / kPitch * x).cosine;
    const FieldValue thick = slab(y + (-1.65) + (-0.5) * teeth, 1.0) + 0.5 * teeth;
    FieldValue bar = intersect(slab(x + (-2.2), 4.8), slab(z + (-kMiddle), 2.4), 1.8);
    return intersect(bar, thick, 0.9);
  }

  Tube shank_{{{{1.5, 0.0, -6.0}, 2.3},
               {{2.7, 0.0, -16.0}, 2.3},
               {{4.4, 0.0, -34.0}, 2.15},
               {{6.2, 0.0, -54.0}, 2.05},
               {{7.2, 0.0, -72.0}, 2.0},
               {{7.2, 0.0, -84.0}, 2.0},
               {{7.9, 0.0, -91.5}, 2.1}},
              kHaemostatFar};
};

struct HaemostatCounts {
  int jaw = 0;
  int shaft = 0;
};

}  // namespace

Tool make_haemostat(const HaemostatShape& shape, Detail detail) {
  const HaemostatCounts counts =
      detail == Detail::k30k ? HaemostatCounts{3002, 8998} : HaemostatCounts{7502, 22498};
  Tool tool;
  for (const double side : {1.0, -1.0}) {
    const Jaw jaw(shape, side);
    const Bounds box{Vec3(-0.0161, -0.0041, -0.0037), Vec3(0.0043, 0.0042, 0.0281)};
    ToolPart part;
    part.name = side > 0.0 ? "left" : "right";
    part.mesh = remesh(jaw, polygonise(jaw, box, 0.00042),
                       {.vertices = counts.jaw, .bend_radius = 0.0008, .finest = 0.25});
    part.is_jaw = true;
    part.open_angle = side * shape.open_angle;
    tool.parts.push_back(std::move(part));
  }
  const Handles handles;
  const Bounds box{Vec3(-0.0291, -0.0047, -0.1211), Vec3(0.0292, 0.0046, 0.0052)};
  ToolPart part;
  part.name = "shaft";
  part.mesh = remesh(handles, polygonise(handles, box, 0.0005),
                     {.vertices = counts.shaft, .bend_radius = 0.0015, .finest = 0.25});
  tool.parts.push_back(std::move(part));
  return tool;
}

}  // namespace palpate::geometry
