#include "palpate/geometry/heart.h"

#include <vector>

#include "palpate/base/units.h"
#include "palpate/geometry/implicit.h"
#include "palpate/geometry/remesh.h"

namespace palpate::geometry {

namespace {

constexpr int kVertices = 3208;  // and so 2 (V - 2) = 6,412 triangles, as in [Zhang 2011, section 3.1]

/// Half axes along `first`, then across it towards `second`, then across both.
Ellipsoid ellipsoid(const Vec3& middle, const Vec3& half_axes, const Vec3& first, const Vec3& second) {
  Mat3 axes;
  axes.col(0) = first.normalized();
  axes.col(2) = first.cross(second).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {middle, half_axes, axes};
}

constexpr double kRim = 2.0;  // [mm] rounding of a cut vessel's edge

/// A vessel that has been cut across: flat at its end, with the lumen showing as a pit.
class CutVessel final {
 public:
  CutVessel(const std::vector<TubeKnot>& knots, double far) : tube_(knots, far), end_(tube_.line().back()) {
    out_ = (end_.middle - tube_.line()[tube_.line().size() - 2].middle).normalized();
  }

  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept {
    const FieldValue tube = tube_.at(p);
    if (tube.value > 2.0 * end_.radius) return tube;
    return intersect(tube, {(p - end_.middle).dot(out_), out_}, kRim);
  }

  /// The lumen: a bowl sunk into the cut, to be taken out of the whole.
  [[nodiscard]] Ellipsoid lumen() const {
    const double width = kLumen * end_.radius;
    const Vec3 across = out_.cross(Vec3(0.36, 0.48, 0.8));
    return ellipsoid(end_.middle, {kDepth * end_.radius, width, width}, out_, across);
  }

 private:
  static constexpr double kLumen = 0.62;  // of the outer radius
  static constexpr double kDepth = 0.45;

  Tube tube_;
  TubeKnot end_;
  Vec3 out_;
};

/// Chambers and vessels, these cut flat. In millimetres until it is meshed.
class SolidHeart : public ImplicitSolid {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    const FieldValue ventricles =
        unite_with_furrow(left_ventricle_.at(p), right_ventricle(p), kFurrowWidth, kFurrowDepth);
    FieldValue atria = unite(left_atrium_.at(p), right_atrium_.at(p), kGroove);
    for (const CutVessel& vessel : veins_) atria = unite(atria, vessel.at(p), kRoot);
    for (const Tube& auricle : auricles_) atria = unite(atria, auricle.at(p), kRoot);
    FieldValue arteries = arteries_.front().at(p);
    for (std::size_t i = 1; i < arteries_.size(); ++i)
      arteries = unite(arteries, arteries_[i].at(p), kBranch);
    for (const Ellipsoid& fold : folds_) atria = unite(atria, fold.at(p), kRoot);
    const FieldValue all = unite(unite(ventricles, atria, kSulcus), arteries, kBranch);
    return {all.value * kMillimetre, all.gradient};
  }

 protected:
  [[nodiscard]] std::vector<Ellipsoid> lumens() const {
    std::vector<Ellipsoid> result;
    for (const CutVessel& vessel : arteries_) result.push_back(vessel.lumen());
    for (const CutVessel& vessel : veins_) result.push_back(vessel.lumen());
    return result;
  }

 private:
  // Widths of the rounding where parts meet [mm]: narrow ones leave the grooves that tell the chambers apart.
  static constexpr double kGroove = 4.0;
  static constexpr double kFurrowWidth = 7.0;  // the interventricular groove
  static constexpr double kFurrowDepth = 1.8;
  static constexpr double kSulcus = 5.0;
  static constexpr double kRoot = 6.0;
  static constexpr double kBranch = 4.0;
  static constexpr double kFar = 12.5;

  [[nodiscard]] FieldValue right_ventricle(const Vec3& p) const noexcept {
    return unite(right_ventricle_.at(p), outflow_.at(p), 12.0);
  }

  Tube left_ventricle_{{{{6.0, 4.0, -10.0}, 26.0},
                        {{15.0, -10.0, -6.0}, 27.0},
                        {{25.0, -26.0, 0.0}, 22.0},
                        {{36.0, -43.0, 7.0}, 11.5}},
                       kFar};
  Tube right_ventricle_{{{{-22.0, -4.0, 4.0}, 19.0},
                         {{-12.0, -15.0, 9.5}, 21.0},
                         {{4.0, -27.0, 12.0}, 17.5},
                         {{21.0, -38.0, 13.0}, 10.0}},
                        kFar};
  Tube outflow_{{{{-12.0, -14.0, 10.0}, 20.0}, {{-2.0, 3.0, 13.0}, 17.0}, {{5.0, 20.0, 11.0}, 13.5}}, kFar};

  Ellipsoid right_atrium_ =
      ellipsoid({-35.0, 5.0, -10.0}, {24.0, 16.5, 19.0}, {0.05, 1.0, 0.0}, Vec3::UnitX());
  Ellipsoid left_atrium_ = ellipsoid({6.0, 17.0, -28.0}, {27.0, 17.0, 15.0}, Vec3::UnitX(), Vec3::UnitY());
  std::vector<Tube> auricles_{Tube({{{-34.0, 14.0, 0.0}, 12.0},
                                    {{-26.0, 19.0, 8.0}, 9.0},
                                    {{-18.0, 21.0, 12.0}, 6.5},
                                    {{-12.0, 20.0, 14.5}, 3.8}},
                                   kFar),
                              Tube({{{26.0, 18.0, -20.0}, 10.0},
                                    {{30.0, 19.0, -8.0}, 8.0},
                                    {{27.0, 20.0, 2.0}, 6.0},
                                    {{21.0, 20.0, 8.0}, 3.5}},
                                   kFar)};
  // Fat and pericardial folds: they close the gaps behind and beside the aorta's root.
  std::vector<Ellipsoid> folds_{
      ellipsoid({1.0, 30.0, -12.0}, {14.0, 13.0, 9.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({-18.0, 10.0, -4.0}, {13.0, 12.0, 14.0}, Vec3::UnitX(), Vec3::UnitY())};

  std::vector<CutVessel> arteries_{
      // Aorta: root, ascending part, arch to the back and left, cut where it turns down.
      CutVessel({{{-3.0, 14.0, -2.0}, 12.5},
                 {{-9.0, 32.0, 1.0}, 12.0},
                 {{-8.0, 47.0, -3.0}, 11.5},
                 {{-1.0, 57.5, -12.0}, 11.0},
                 {{9.0, 58.0, -24.0}, 10.0},
                 {{15.0, 51.0, -33.0}, 9.5},
                 {{16.5, 43.5, -36.0}, 9.2}},
                kFar),
      // Brachiocephalic trunk, left common carotid and left subclavian artery.
      CutVessel({{{-8.0, 53.0, -5.0}, 5.8}, {{-11.0, 64.0, -5.0}, 5.0}, {{-13.0, 73.0, -5.0}, 5.0}}, kFar),
      CutVessel({{{0.0, 59.0, -13.0}, 4.5}, {{0.5, 68.0, -13.0}, 4.0}, {{1.0, 75.0, -13.0}, 4.0}}, kFar),
      CutVessel({{{8.0, 59.0, -22.0}, 5.0}, {{11.5, 67.0, -22.5}, 4.3}, {{14.0, 74.0, -23.0}, 4.3}}, kFar),
      // Pulmonary trunk, crossing in front of the aorta, and its left and right branches.
      CutVessel({{{5.0, 18.0, 10.0}, 12.5},
                 {{9.0, 31.0, 7.0}, 11.5},
                 {{15.0, 39.0, -3.0}, 10.5},
                 {{25.0, 42.0, -13.0}, 8.5},
                 {{38.0, 41.0, -19.0}, 8.0}},
                kFar),
      CutVessel({{{13.0, 38.0, -6.0}, 7.5},
                 {{2.0, 36.0, -18.0}, 7.2},
                 {{-14.0, 37.5, -27.0}, 6.8},
                 {{-36.0, 40.0, -31.0}, 6.6}},
                kFar)};

  std::vector<CutVessel> veins_{
      // Superior and inferior vena cava.
      CutVessel({{{-36.0, 18.0, -12.0}, 10.0}, {{-37.0, 36.0, -9.0}, 8.8}, {{-36.0, 58.0, -8.0}, 8.4}}, kFar),
      CutVessel({{{-33.0, -8.0, -16.0}, 11.0}, {{-31.0, -22.0, -19.0}, 10.0}, {{-30.0, -36.0, -20.0}, 10.0}},
                kFar),
      // Four pulmonary veins.
      CutVessel({{{24.0, 22.0, -30.0}, 6.2}, {{34.0, 25.0, -32.0}, 5.2}, {{42.0, 26.0, -33.0}, 5.2}}, kFar),
      CutVessel({{{24.0, 10.0, -32.0}, 6.2}, {{34.0, 7.0, -34.0}, 5.2}, {{41.0, 6.0, -35.0}, 5.2}}, kFar),
      CutVessel({{{-13.0, 20.0, -33.0}, 6.0}, {{-25.0, 21.0, -37.5}, 5.2}, {{-35.0, 21.0, -40.5}, 5.2}},
                kFar),
      CutVessel({{{-13.0, 9.0, -33.0}, 6.0}, {{-23.0, 3.5, -38.0}, 5.2}, {{-32.0, 1.0, -41.0}, 5.2}}, kFar)};
};

/// The same with the vessels' lumens as pits.
class Heart final : public SolidHeart {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    FieldValue all = SolidHeart::at(p_m);
    const Vec3 p = p_m / kMillimetre;
    for (const Ellipsoid& lumen : lumens_) {
      const double reach = lumen.half_axes.x() + lumen.half_axes.y();
      if ((p - lumen.middle).squaredNorm() > reach * reach) continue;
      const FieldValue pit = lumen.at(p);
      all = subtract(all, {pit.value * kMillimetre, pit.gradient}, kRim * kMillimetre);
    }
    return all;
  }

 private:
  std::vector<Ellipsoid> lumens_ = lumens();
};

}  // namespace

TriangleMesh make_heart() {
  const Bounds box{Vec3(-0.070, -0.070, -0.065), Vec3(0.070, 0.085, 0.050)};
  constexpr double kSpacing = 0.004;  // too coarse for the rims of the cut vessels, which come in remeshing
  const TriangleMesh start = polygonise(SolidHeart(), box, kSpacing);
  return remesh(Heart(), start, {.vertices = kVertices, .bend_radius = 0.02, .finest = 0.2});
}

}  // namespace palpate::geometry
