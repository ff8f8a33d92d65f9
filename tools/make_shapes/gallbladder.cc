#include <vector>

#include "core/base/portable_math.h"
#include "palpate/units.h"

#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/organs.h"
#include "tools/make_shapes/remesh.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

namespace {

constexpr int kGallbladderVertices = 1057;  // 2 (V - 2) = 2,110 triangles [Zhang 2011, section 3.1]

/// In millimetres until it is meshed. A gallbladder is 70 to 100 mm long, 30 to 40 mm wide, and slightly
/// flat.
class Gallbladder final : public ImplicitSolid {
 public:
  Gallbladder(bool with_lumen) : with_lumen_(with_lumen) {}

  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    FieldValue all = unite(flattened(p), pouch_.at(p), 15.0);
    all = unite(all, unite(duct_.at(p), fold_.at(p), 2.4), 9.0);
    const TubeKnot& end = duct_.end();
    const Vec3 out = duct_.end_direction();
    all = intersect(all, {(p - end.middle).dot(out), out}, 1.2);
    if (with_lumen_) all = subtract(all, lumen_.at(p), 0.7);
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  static constexpr double kFar = 15.5;  // [mm] larger than all blends

  /// Fundus, body and neck: a swept round shape, compressed along z.
  [[nodiscard]] FieldValue flattened(const Vec3& p) const noexcept {
    constexpr double kFlat = 0.88;
    const FieldValue round = body_.at({p.x(), p.y(), p.z() / kFlat});
    const Vec3& g = round.gradient;
    return {kFlat * round.value, kFlat * Vec3(g.x(), g.y(), g.z() / kFlat)};
  }

  /// The spiral fold of the duct's wall (Heister's valve), as a ridge around the duct.
  [[nodiscard]] static Tube spiral(const Tube& duct) {
    constexpr double kFrom = 0.42;  // start, as a fraction of the duct
    constexpr double kTo = 0.94;
    constexpr int kTurns = 5;
    constexpr int kKnots = 8;  // per turn
    constexpr double kOut = 0.62;
    constexpr double kRadius = 0.60;  // this and the next relative to the duct's radius
    std::vector<TubeKnot> knots;
    for (int i = 0; i <= kTurns * kKnots; ++i) {
      const double share = kFrom + (kTo - kFrom) * i / (kTurns * kKnots);
      const TubeKnot here = duct.knot_at(share);
      const Vec3 along = (duct.knot_at(share + 0.01).middle - duct.knot_at(share - 0.01).middle).normalized();
      const Vec3 side = along.cross(Vec3::UnitZ()).normalized();
      const portable::SinCos turn = portable::sin_cos(2.0 * portable::kPi * i / kKnots);
      const Vec3 away = turn.cosine * side + turn.sine * along.cross(side);
      knots.push_back({here.middle + kOut * here.radius * away, kRadius * here.radius});
    }
    return {knots, kFar};
  }

  [[nodiscard]] static Ellipsoid lumen(const Tube& duct) {
    const double radius = duct.end().radius;
    Mat3 axes;
    axes.col(0) = duct.end_direction();
    axes.col(1) = axes.col(0).cross(Vec3(0.0, 0.0, 1.0)).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return {duct.end().middle, {0.6 * radius, 0.56 * radius, 0.56 * radius}, axes};
  }

  bool with_lumen_;
  Tube body_{{{{-30.5, -1.5, -0.5}, 13.5},
              {{-22.5, -1.0, -0.3}, 17.3},
              {{-12.0, -0.3, 0.0}, 19.0},
              {{-1.0, 0.3, 0.2}, 18.1},
              {{9.5, 0.2, 0.0}, 15.3},
              {{18.0, -0.6, -0.8}, 11.2},
              {{25.0, -0.8, -1.2}, 7.8}},
             kFar};
  // Hartmann's pouch: a bulge of the neck's wall towards the duct.
  Ellipsoid pouch_{{20.0, -5.6, -3.5}, {9.5, 7.6, 7.6}, Mat3::Identity()};
  Tube duct_{{{{22.5, -0.6, -0.8}, 7.6},
              {{28.5, 3.6, 1.0}, 6.0},
              {{34.0, 6.8, 2.4}, 4.5},
              {{39.0, 6.6, 2.4}, 3.4},
              {{42.8, 3.4, 1.2}, 2.7},
              {{45.6, 0.2, -0.4}, 2.5},
              {{48.8, -1.6, -1.6}, 2.4},
              {{52.3, -1.0, -2.0}, 2.4}},
             kFar};
  Tube fold_ = spiral(duct_);
  Ellipsoid lumen_ = lumen(duct_);
};

}  // namespace

TriangleMesh make_gallbladder(Detail detail) {
  const Gallbladder plain(false);
  const Bounds box{Vec3(-0.050, -0.026, -0.024), Vec3(0.060, 0.026, 0.024)};
  constexpr double kSpacing = 0.0025;  // fine enough for the duct
  const TriangleMesh start = polygonise(plain, box, kSpacing);
  if (detail == Detail::kPaper) return remesh(plain, start, {.vertices = kGallbladderVertices});
  RemeshParameters goal{.vertices = 15002, .bend_radius = 0.004, .finest = 0.2};
  if (detail == Detail::k75k)
    goal = {.vertices = 9377, .subdivisions = 1, .bend_radius = 0.003, .finest = 0.2};
  return remesh(Gallbladder(true), start, goal);
}

}  // namespace palpate::geometry
