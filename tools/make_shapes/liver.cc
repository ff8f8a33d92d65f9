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

constexpr int kLiverVertices = 3502;  // gives 2 (V - 2) = 7,000 triangles

constexpr double kLiverFar = 16.5;  // [mm] larger than all blends

// Position and direction of the cut of the inferior vena cava above the liver [mm].
const Vec3 kCavaTop(-3.0, 75.0, -40.0);
const Vec3 kCavaUp = Vec3(0.0, 0.93, 0.37).normalized();

/// The visceral surface without its impressions, as its height y over x and z [mm]: an arch that rises to the
/// left and towards the back.
FieldValue visceral_height(const FieldValue& x, const FieldValue& z) {
  return 0.53 * x + -0.0013 * (x * x) + -0.50 * z + -5.5;
}

/// A point of the visceral surface, or `inside` [mm] above it, in the liver.
Vec3 under(double x, double z, double inside = 0.0) {
  return {x, visceral_height({x, Vec3::Zero()}, {z, Vec3::Zero()}).value + inside, z};
}

/// Unit normal of the visceral surface, outwards.
Vec3 visceral_normal(double x, double z) {
  const FieldValue height = visceral_height({x, Vec3::UnitX()}, {z, Vec3::UnitZ()});
  return (height.gradient - Vec3::UnitY()).normalized();
}

/// An ellipsoid that presses `depth` [mm] into the visceral surface at (x, z): half axes along `first`,
/// across it, and away from the surface.
Ellipsoid impression(double x, double z, double depth, const Vec3& half_axes, const Vec3& first) {
  const Vec3 out = visceral_normal(x, z);
  const Vec3 along = first - first.dot(out) * out;
  return ellipsoid(under(x, z) + (half_axes.z() - depth) * out, half_axes, along, out.cross(along));
}

/// An ellipsoid that rises `height` [mm] from the visceral surface; half axes as for an impression.
Ellipsoid swelling(double x, double z, double height, const Vec3& half_axes, const Vec3& first) {
  const Vec3 out = visceral_normal(x, z);
  const Vec3 along = first - first.dot(out) * out;
  return ellipsoid(under(x, z) - (half_axes.z() - height) * out, half_axes, along, out.cross(along));
}

/// In millimetres until it is meshed.
class Liver final : public ImplicitSolid {
 public:
  /// Details that a mesh can resolve: no lumens of vessels; the veins' lumens, for a coarse mesh; or all
  /// lumens, and the true height and width of the falciform ligament's stump.
  enum Shown { kNoLumens, kCoarse, kFine };
  explicit Liver(Shown shown) : shown_(shown) {}

  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    FieldValue all = lobes(p);
    for (const Ellipsoid& lobe : swellings_) all = unite(all, lobe.at(p), kSwell);
    all = unite(all, caudate_.at(p), 6.0);
    all = unite(all, papilla_.at(p), kSwell);
    for (const Tube& fissure : fissures_) all = subtract(all, fissure.at(p), kFissure);
    all = subtract(all, fossa_.at(p), kFossa);
    all = unite(all, cava(p), kCava);
    all = unite(all, round_ligament_.at(p), kRoot);
    for (const CutVessel& vessel : vessels_) all = unite(all, vessel.at(p), kRoot);
    if (shown_ == kNoLumens) return {all.value * kMillimetre, all.gradient};
    for (const Ellipsoid& lumen : wide_lumens_) all = subtract(all, lumen.at(p), kLumenRim);
    if (shown_ == kFine) {
      for (const Ellipsoid& lumen : narrow_lumens_) all = subtract(all, lumen.at(p), kLumenRim);
    }
    return {all.value * kMillimetre, all.gradient};
  }

  [[nodiscard]] std::vector<VesselLine> lines() const {
    return {line_of("vein", cava_.tube(), 12), line_of("vein", vessels_[0].tube(), 8),
            line_of("duct", vessels_[1].tube(), 8), line_of("artery", vessels_[2].tube(), 8)};
  }

 private:
  // Blend widths where parts meet [mm].
  static constexpr double kMargin = 5.0;  // the lower margin: sharp
  static constexpr double kDome = 48.0;
  static constexpr double kImpression = 14.0;
  static constexpr double kSwell = 9.0;
  static constexpr double kFissure = 7.0;
  static constexpr double kFossa = 8.0;
  static constexpr double kCava = 8.0;
  static constexpr double kRoot = 4.0;
  static constexpr double kLumenRim = 1.0;

  /// Both lobes: the shape of the diaphragm, bounded below by the visceral surface with its impressions.
  [[nodiscard]] FieldValue lobes(const Vec3& p) const noexcept {
    const FieldValue x = coordinate(p, Vec3::UnitX());
    const FieldValue y = coordinate(p, Vec3::UnitY());
    const FieldValue z = coordinate(p, Vec3::UnitZ());
    const FieldValue above = y - visceral_height(x, z);
    FieldValue dome = unite(unite(right_.at(p), flank_.at(p), kDome), left_.at(p), kDome);
    dome = subtract(dome, heart_.at(p), 2.0 * kImpression);
    // The stump of the falciform ligament, in a shallow groove between the lobes, at the front and the top.
    const FieldValue off = x + (-26.0) + 0.06 * y;
    const FieldValue there = rise(above, 6.0, 24.0) * rise(z + 0.5 * y, -30.0, -5.0);
    const FieldValue stump = shown_ == kFine ? 2.2 * bump(off, 4.2) : 2.2 * bump(off, 8.0);
    dome = dome + there * (1.6 * bump(off, 18.0) - stump);
    constexpr double kSteepness = 0.76;  // scales the height's gradient to about 1
    FieldValue all = intersect(dome, -kSteepness * above, kMargin);
    for (const Ellipsoid& organ : impressions_) all = subtract(all, organ.at(p), kImpression);
    return all;
  }

  /// The inferior vena cava; its upper end is cut too.
  [[nodiscard]] FieldValue cava(const Vec3& p) const noexcept {
    FieldValue vessel = cava_.at(p);
    if (vessel.value > kLiverFar) return vessel;
    return intersect(vessel, {(p - kCavaTop).dot(kCavaUp), kCavaUp}, CutVessel::kRim);
  }

  Shown shown_;
  Ellipsoid right_ = ellipsoid({-36.0, -12.0, -8.0}, {66.0, 92.0, 71.0}, Vec3::UnitX(), Vec3::UnitY());
  Ellipsoid flank_ = ellipsoid({-68.0, -38.0, -4.0}, {36.0, 56.0, 50.0}, {1.0, 0.12, 0.0}, Vec3::UnitY());
  Ellipsoid left_ = ellipsoid({36.0, 27.0, 6.0}, {75.0, 42.0, 47.0}, {0.97, 0.16, -0.08}, Vec3::UnitY());
  Ellipsoid heart_ = ellipsoid({28.0, 102.0, 2.0}, {58.0, 42.0, 50.0}, Vec3::UnitX(), Vec3::UnitY());

  std::vector<Ellipsoid> impressions_{
      impression(-62.0, -30.0, 11.0, {46.0, 32.0, 34.0}, {0.0, 0.6, -1.0}),  // right kidney
      impression(-76.0, 26.0, 5.0, {64.0, 36.0, 40.0}, {1.0, 0.0, 0.0}),     // right flexure of the colon
      impression(72.0, 4.0, 10.0, {56.0, 46.0, 52.0}, {1.0, 0.0, -0.2})};    // stomach
  // Quadrate lobe and tuber omentale.
  std::vector<Ellipsoid> swellings_{swelling(8.0, 21.0, 7.0, {24.0, 16.0, 18.0}, {0.0, 0.0, 1.0}),
                                    swelling(42.0, -14.0, 5.0, {16.0, 14.0, 14.0}, {1.0, 0.0, 0.0})};
  Ellipsoid caudate_ = ellipsoid({14.0, 18.0, -44.0}, {13.5, 30.0, 17.0}, Vec3::UnitX(), {0.0, 1.0, -0.25});
  Ellipsoid papilla_ = ellipsoid({18.0, 1.0, -30.0}, {9.0, 10.0, 9.0}, Vec3::UnitX(), Vec3::UnitY());
  std::vector<Tube> fissures_{// fissure of the round ligament, with the notch in the margin
                              Tube({{under(27.0, 76.0, 2.0), 8.0},
                                    {under(27.0, 60.0, 2.0), 8.0},
                                    {under(27.5, 40.0, 2.0), 6.0},
                                    {under(27.5, 18.0, 2.0), 4.8},
                                    {under(27.0, 2.0, 2.0), 5.5}},
                                   kLiverFar),
                              // Porta hepatis.
                              Tube({{under(-10.0, -5.0, 1.0), 5.5},
                                    {under(2.0, -3.0, 2.0), 7.0},
                                    {under(16.0, -2.0, 2.0), 7.0},
                                    {under(27.0, 0.0, 2.0), 5.5}},
                                   kLiverFar),
                              // Fissure of the venous ligament.
                              Tube({{under(27.0, 0.0, 2.0), 5.0},
                                    {under(30.0, -16.0, 2.0), 4.2},
                                    {under(32.0, -34.0, 2.0), 4.2},
                                    {under(32.0, -52.0, 6.0), 5.0},
                                    {under(31.0, -66.0, 14.0), 6.0}},
                                   kLiverFar)};
  Ellipsoid fossa_ = impression(-16.0, 18.0, 11.0, {38.0, 17.0, 17.0}, {-0.22, 0.0, 1.0});
  CutVessel cava_{{{{-3.0, 78.0, -38.8}, 11.0},
                   {{-3.0, 56.0, -47.5}, 12.0},
                   {{-3.5, 30.0, -55.0}, 12.5},
                   {{-3.2, 10.0, -55.0}, 11.8},
                   {{-2.5, -9.0, -53.5}, 11.3}},
                  kLiverFar};
  Tube round_ligament_{{{under(27.3, 30.0, 7.5), 3.2},
                        {under(27.2, 44.0, 7.5), 3.4},
                        {under(27.0, 54.0, 5.0), 3.4},
                        {under(27.0, 63.0, -3.0), 3.2}},
                       kLiverFar};
  std::vector<CutVessel> vessels_{// Portal vein.
                                  CutVessel({{{8.0, 7.0, -1.0}, 8.0},
                                             {{9.0, -7.0, -4.0}, 6.6},
                                             {{12.0, -19.0, -8.0}, 6.3},
                                             {{15.0, -30.0, -13.0}, 6.3}},
                                            kLiverFar),
                                  // Bile duct.
                                  CutVessel({{{-2.0, 1.0, 2.0}, 4.6},
                                             {{-1.0, -12.0, 4.0}, 3.3},
                                             {{1.0, -23.0, 2.0}, 3.0},
                                             {{4.0, -34.0, -3.0}, 3.0}},
                                            kLiverFar),
                                  // Hepatic artery.
                                  CutVessel({{{19.0, 5.0, 2.0}, 4.2},
                                             {{20.5, -5.0, 3.5}, 2.9},
                                             {{21.5, -15.0, 2.5}, 2.7},
                                             {{24.0, -25.0, -1.0}, 2.7}},
                                            kLiverFar)};
  std::vector<Ellipsoid> wide_lumens_{
      cava_.lumen(), ellipsoid(kCavaTop, {5.0, 7.0, 7.0}, kCavaUp, Vec3::UnitX()), vessels_[0].lumen()};
  std::vector<Ellipsoid> narrow_lumens_{vessels_[1].lumen(), vessels_[2].lumen()};
};

}  // namespace

TriangleMesh make_liver(Detail detail) {
  const Bounds box{Vec3(-0.125, -0.105, -0.095), Vec3(0.130, 0.098, 0.085)};
  constexpr double kSpacing = 0.003;  // fine enough for the cut vessels
  const TriangleMesh start = polygonise(Liver(Liver::kNoLumens), box, kSpacing);
  RemeshParameters goal{.vertices = kLiverVertices, .bend_radius = 0.0115, .finest = 0.2};
  if (detail == Detail::k30k) goal = {.vertices = 15002, .bend_radius = 0.010, .finest = 0.2};
  if (detail == Detail::k75k)
    goal = {.vertices = 9377, .subdivisions = 1, .bend_radius = 0.010, .finest = 0.2};
  return remesh(Liver(detail == Detail::kPaper ? Liver::kCoarse : Liver::kFine), start, goal);
}

std::vector<VesselLine> liver_vessels() { return Liver(Liver::kFine).lines(); }

}  // namespace palpate::geometry
