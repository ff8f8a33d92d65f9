#include "palpate/geometry/gallbladder.h"

#include "palpate/base/units.h"
#include "palpate/geometry/implicit.h"
#include "palpate/geometry/remesh.h"

namespace palpate::geometry {

namespace {

constexpr int kVertices = 1057;  // and 2 (V - 2) = 2,110 triangles, as in [Zhang 2011, section 3.1]

/// In millimetres until it is meshed; a gallbladder is some 90 mm long and 38 mm wide, flatter than wide.
class Gallbladder final : public ImplicitSolid {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    FieldValue body = flattened(p);
    body = unite(body, pouch_.at(p), 7.0);
    FieldValue all = unite(body, duct_.at(p), 3.5);
    const TubeKnot& end = duct_.line().back();
    const Vec3 out = (end.middle - duct_.line()[duct_.line().size() - 2].middle).normalized();
    all = intersect(all, {(p - end.middle).dot(out), out}, 1.2);
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  static constexpr double kFar = 8.0;  // [mm] more than any blend

  /// Fundus and body: a swept round shape, pressed flat along z to a share.
  [[nodiscard]] FieldValue flattened(const Vec3& p) const noexcept {
    constexpr double kFlat = 0.88;
    const FieldValue round = body_.at({p.x(), p.y(), p.z() / kFlat});
    const Vec3& g = round.gradient;
    return {kFlat * round.value, kFlat * Vec3(g.x(), g.y(), g.z() / kFlat)};
  }

  Tube body_{{{{-31.0, -1.5, -0.5}, 12.5},
              {{-24.0, -1.0, -0.3}, 17.0},
              {{-13.0, -0.3, 0.0}, 19.3},
              {{-1.0, 0.5, 0.3}, 18.0},
              {{11.5, 0.5, 0.0}, 14.2},
              {{20.0, -0.5, -1.0}, 9.2},
              {{27.0, -0.5, -1.5}, 6.4}},
             kFar};
  Ellipsoid pouch_{{21.5, -5.0, -3.0}, {9.0, 7.6, 7.2}, Mat3::Identity()};
  // The folds of the spiral valve show as a slight beading of the duct.
  Tube duct_{{{{24.0, 0.0, -1.0}, 6.0},
              {{30.5, 3.5, 1.5}, 4.3},
              {{34.5, 6.5, 2.0}, 2.9},
              {{37.5, 6.0, 1.0}, 3.4},
              {{39.5, 3.0, 0.0}, 2.7},
              {{42.0, 0.0, -1.0}, 3.2},
              {{45.5, -1.2, -1.5}, 2.6},
              {{48.5, -0.6, -2.0}, 2.8}},
             kFar};
};

}  // namespace

TriangleMesh make_gallbladder() {
  const Gallbladder solid;
  const Bounds box{Vec3(-0.050, -0.026, -0.024), Vec3(0.060, 0.026, 0.024)};
  constexpr double kSpacing = 0.0025;  // fine enough for the duct
  return remesh(solid, polygonise(solid, box, kSpacing), {.vertices = kVertices});
}

}  // namespace palpate::geometry
