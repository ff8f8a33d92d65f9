#include <array>
#include <vector>

#include "palpate/units.h"

#include "tools/make_shapes/cut_vessel.h"
#include "tools/make_shapes/field_arithmetic.h"
#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/organs.h"
#include "tools/make_shapes/remesh.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

namespace {

constexpr int kKidneyVertices = 3002;  // gives 2 (V - 2) = 6,000 triangles

/// In millimetres until it is meshed.
class Kidney final : public ImplicitSolid {
 public:
  explicit Kidney(bool with_lumens) : with_lumens_(with_lumens) {}

  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    FieldValue all = subtract(lobed(p), sinus_.at(p), kLip);
    for (const Ellipsoid& pad : fat_) all = unite(all, pad.at(p), kFatBlend);
    for (const CutVessel& vessel : vessels_) all = unite(all, vessel.at(p), kRoot);
    if (with_lumens_) {
      for (const Ellipsoid& lumen : lumens_) all = subtract(all, lumen.at(p), kLumenRim);
    }
    return {all.value * kMillimetre, all.gradient};
  }

  [[nodiscard]] std::vector<VesselLine> lines() const {
    return {line_of("vein", vessels_[0].tube(), 8), line_of("artery", vessels_[1].tube(), 8),
            line_of("duct", vessels_[2].tube(), 12)};
  }

 private:
  // Blend widths where parts meet [mm].
  static constexpr double kLip = 7.0;
  static constexpr double kFatBlend = 5.0;
  static constexpr double kRoot = 4.0;
  static constexpr double kLumenRim = 0.8;
  static constexpr double kFar = 8.0;  // larger than all blends

  /// The bean: a swept round shape, compressed along z.
  [[nodiscard]] FieldValue bean(const Vec3& p) const noexcept {
    constexpr double kFlat = 0.78;
    const FieldValue round = body_.at({p.x(), p.y(), p.z() / kFlat});
    const Vec3& g = round.gradient;
    return {kFlat * round.value, kFlat * Vec3(g.x(), g.y(), g.z() / kFlat)};
  }

  /// The bean with shallow furrows between its foetal lobes: across it, fading towards the hilum, and one
  /// along the outer border.
  [[nodiscard]] FieldValue lobed(const Vec3& p) const noexcept {
    FieldValue all = bean(p);
    if (all.value > 2.0 * kFar) return all;
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ());
    constexpr double kDepth = 0.7;  // [mm]
    const FieldValue outer = rise(-x, -8.0, 20.0);
    FieldValue furrows = 0.55 * bump(z + 0.06 * y + 1.0, 8.0);
    struct Across {
      double at, tilt, bend;
    };
    for (const Across& a : {Across{33.0, -0.35, 0.010}, Across{14.0, 0.12, -0.012},
                            Across{-7.0, -0.10, 0.012}, Across{-27.0, 0.28, -0.008}}) {
      const FieldValue off = y + (-a.at) + a.tilt * x + a.bend * (z * z) + 0.1 * z;
      furrows = furrows + bump(off, 8.0);
    }
    return all + kDepth * (outer * furrows);
  }

  bool with_lumens_;
  Tube body_{{{{10.0, 33.5, -1.5}, 21.5},
              {{0.5, 18.0, -0.5}, 26.0},
              {{-3.5, 0.0, 0.5}, 26.8},
              {{-1.5, -18.0, 0.5}, 25.8},
              {{7.0, -34.0, 0.0}, 20.8}},
             kFar};
  Ellipsoid sinus_ = ellipsoid({28.0, -0.5, 1.0}, {17.0, 19.0, 9.0}, {1.0, 0.0, 0.18}, Vec3::UnitY());
  // The fat of the sinus, beside the vessels.
  std::array<Ellipsoid, 2> fat_{
      ellipsoid({12.0, 0.0, 0.0}, {8.0, 15.0, 8.5}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({14.5, -11.0, -3.0}, {8.5, 9.0, 8.0}, Vec3::UnitX(), Vec3::UnitY())};
  std::vector<CutVessel> vessels_{
      // Renal vein, in front.
      CutVessel(
          {{{8.0, 2.0, 2.5}, 6.5}, {{19.0, 3.0, 5.0}, 5.6}, {{29.0, 3.5, 6.5}, 5.0}, {{37.0, 4.5, 6.0}, 5.0}},
          kFar),
      // Renal artery.
      CutVessel({{{10.0, 9.0, -1.0}, 4.2},
                 {{20.0, 11.5, -1.5}, 3.4},
                 {{30.0, 13.5, -2.0}, 2.9},
                 {{37.5, 14.7, -2.5}, 2.9}},
                kFar),
      // Renal pelvis, which narrows into the ureter and turns down.
      CutVessel({{{9.0, -2.0, -2.0}, 8.5},
                 {{18.0, -3.5, -4.0}, 7.2},
                 {{25.5, -8.5, -6.0}, 5.2},
                 {{30.5, -18.0, -7.0}, 3.4},
                 {{32.0, -30.0, -7.0}, 2.7},
                 {{32.0, -43.0, -6.5}, 2.6}},
                kFar)};
  std::array<Ellipsoid, 3> lumens_{vessels_[0].lumen(), vessels_[1].lumen(), vessels_[2].lumen()};
};

}  // namespace

TriangleMesh make_kidney(Detail detail) {
  const Bounds box{Vec3(-0.036, -0.062, -0.027), Vec3(0.048, 0.062, 0.028)};
  constexpr double kSpacing = 0.0018;  // fine enough for the ureter
  const TriangleMesh start = polygonise(Kidney(false), box, kSpacing);
  RemeshParameters goal{.vertices = kKidneyVertices, .bend_radius = 0.008, .finest = 0.2};
  if (detail == Detail::k30k) goal = {.vertices = 15002, .bend_radius = 0.005, .finest = 0.2};
  if (detail == Detail::k75k)
    goal = {.vertices = 9377, .subdivisions = 1, .bend_radius = 0.005, .finest = 0.2};
  return remesh(Kidney(true), start, goal);
}

std::vector<VesselLine> kidney_vessels() { return Kidney(true).lines(); }

}  // namespace palpate::geometry
