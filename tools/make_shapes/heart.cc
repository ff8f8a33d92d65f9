#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "palpate/units.h"

#include "tools/make_shapes/cut_vessel.h"
#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/organs.h"
#include "tools/make_shapes/remesh.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

namespace {

constexpr int kHeartVertices = 3208;  // gives 2 (V - 2) = 6,412 triangles, as in [Zhang 2011, section 3.1]

/// Chambers and the cut vessels. In millimetres.
class Chambers {
 public:
  [[nodiscard]] FieldValue left_ventricle(const Vec3& p) const noexcept { return left_ventricle_.at(p); }
  [[nodiscard]] FieldValue right_ventricle(const Vec3& p) const noexcept {
    return unite(right_ventricle_.at(p), outflow_.at(p), 17.0);
  }
  [[nodiscard]] FieldValue ventricles(const Vec3& p) const noexcept {
    return unite_with_furrow(left_ventricle(p), right_ventricle(p), kFurrowWidth, kFurrowDepth);
  }
  [[nodiscard]] FieldValue atria(const Vec3& p) const noexcept {
    FieldValue atria = unite(left_atrium_.at(p), right_atrium_.at(p), kGroove);
    for (const CutVessel& vessel : veins_) atria = unite(atria, vessel.at(p), kRoot);
    for (const Tube& auricle : auricles_) atria = unite(atria, auricle.at(p), kRoot);
    for (const Ellipsoid& fold : folds_) atria = unite(atria, fold.at(p), kRoot);
    return atria;
  }
  [[nodiscard]] FieldValue arteries(const Vec3& p) const noexcept {
    FieldValue arteries = arteries_.front().at(p);
    for (std::size_t i = 1; i < arteries_.size(); ++i)
      arteries = unite(arteries, arteries_[i].at(p), kBranch);
    return arteries;
  }
  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept {
    const FieldValue chambers = unite_with_furrow(ventricles(p), atria(p), kSulcus, kSulcusDepth);
    return unite(unite(chambers, septum_.at(p), kBranch), arteries(p), kBranch);
  }
  [[nodiscard]] std::vector<VesselLine> lines() const {
    std::vector<VesselLine> lines;
    for (const CutVessel& vessel : arteries_) lines.push_back(line_of("artery", vessel.tube(), 12));
    for (const CutVessel& vessel : veins_) lines.push_back(line_of("vein", vessel.tube(), 6));
    return lines;
  }
  [[nodiscard]] std::vector<Ellipsoid> lumens() const {
    std::vector<Ellipsoid> result;
    for (const CutVessel& vessel : arteries_) result.push_back(vessel.lumen());
    for (const CutVessel& vessel : veins_) result.push_back(vessel.lumen());
    return result;
  }

 private:
  // Blend widths [mm] where parts meet; narrow blends leave the grooves between the chambers.
  static constexpr double kGroove = 5.5;
  static constexpr double kFurrowWidth = 10.0;  // the interventricular groove
  static constexpr double kFurrowDepth = 1.9;
  static constexpr double kSulcus = 10.0;  // the atrioventricular groove
  static constexpr double kSulcusDepth = 1.2;
  static constexpr double kRoot = 8.5;
  static constexpr double kBranch = 5.0;
  static constexpr double kFar = 17.5;

  Tube left_ventricle_{{{{6.0, 4.0, -10.0}, 26.0},
                        {{14.5, -10.0, -6.0}, 27.0},
                        {{24.0, -26.0, 0.0}, 21.5},
                        {{34.0, -42.0, 6.0}, 11.5}},
                       kFar};
  Tube right_ventricle_{{{{-22.0, -3.0, 4.0}, 19.0},
                         {{-12.0, -14.0, 9.5}, 21.0},
                         {{4.0, -25.5, 12.0}, 17.5},
                         {{19.0, -35.5, 11.5}, 10.0}},
                        kFar};
  Tube outflow_{{{{-12.0, -14.0, 10.0}, 20.0}, {{-2.0, 3.0, 13.0}, 17.0}, {{5.0, 20.0, 11.0}, 13.3}}, kFar};

  Ellipsoid right_atrium_ =
      ellipsoid({-35.0, 5.0, -10.0}, {24.0, 16.5, 19.0}, {0.05, 1.0, 0.0}, Vec3::UnitX());
  Ellipsoid left_atrium_ = ellipsoid({6.0, 17.0, -28.0}, {27.0, 17.0, 15.0}, Vec3::UnitX(), Vec3::UnitY());
  // The auricles' radius varies along them, so that their edges are notched.
  std::vector<Tube> auricles_{Tube({{{-35.0, 13.0, 0.0}, 12.0},
                                    {{-29.5, 19.0, 8.0}, 10.0},
                                    {{-24.5, 23.5, 12.5}, 8.2},
                                    {{-19.5, 26.0, 14.8}, 7.7},
                                    {{-14.5, 26.8, 15.6}, 6.2},
                                    {{-10.0, 26.5, 15.6}, 5.3}},
                                   kFar),
                              Tube({{{26.0, 18.0, -22.0}, 10.5},
                                    {{31.0, 19.5, -13.0}, 8.8},
                                    {{32.0, 21.0, -4.0}, 8.0},
                                    {{29.5, 22.5, 4.0}, 6.4},
                                    {{25.0, 23.0, 9.5}, 5.4}},
                                   kFar)};
  // Fills the gap between the chambers.
  Ellipsoid septum_ = ellipsoid({-15.5, -3.5, -15.5}, {16.0, 15.5, 14.0}, Vec3::UnitX(), Vec3::UnitY());
  // Fat and pericardial folds: they fill the gaps behind and beside the aorta's root.
  std::vector<Ellipsoid> folds_{
      ellipsoid({1.0, 30.0, -12.0}, {14.0, 13.0, 9.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({-18.0, 10.0, -4.0}, {13.0, 12.0, 14.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({3.5, 40.5, -8.0}, {8.0, 7.0, 11.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({-10.0, 15.5, 10.0}, {12.5, 11.0, 11.5}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({-22.0, 27.0, -17.0}, {13.0, 13.0, 11.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({22.5, 15.5, 3.0}, {10.0, 9.0, 12.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({29.0, 13.5, -10.0}, {8.0, 8.0, 14.0}, Vec3::UnitX(), Vec3::UnitY()),
      ellipsoid({-16.0, 0.0, -25.0}, {12.0, 10.0, 9.0}, Vec3::UnitX(), Vec3::UnitY())};

  std::vector<CutVessel> arteries_{
      // Aorta: root, ascending part, arch to the back and left, cut where it descends.
      CutVessel({{{-3.0, 14.0, -2.0}, 13.0},
                 {{-8.0, 29.0, 1.0}, 12.6},
                 {{-9.0, 42.0, -1.0}, 11.8},
                 {{-4.5, 54.0, -8.0}, 11.2},
                 {{4.0, 59.0, -18.0}, 10.5},
                 {{11.5, 56.0, -28.0}, 9.8},
                 {{15.5, 46.0, -34.5}, 9.4},
                 {{16.5, 38.0, -37.0}, 9.2}},
                kFar),
      // Brachiocephalic trunk, left common carotid and left subclavian artery.
      CutVessel({{{-7.0, 53.0, -6.0}, 6.0}, {{-10.5, 64.0, -5.5}, 5.2}, {{-14.0, 73.5, -5.0}, 5.2}}, kFar),
      CutVessel({{{0.5, 59.0, -14.0}, 4.5}, {{0.5, 68.0, -13.5}, 3.9}, {{0.0, 75.5, -13.0}, 3.9}}, kFar),
      CutVessel({{{8.0, 59.0, -22.0}, 5.0}, {{11.5, 67.0, -22.5}, 4.3}, {{14.0, 74.0, -23.0}, 4.3}}, kFar),
      // Pulmonary trunk, which crosses in front of the aorta, and its left and right branches.
      CutVessel({{{3.0, 12.0, 11.0}, 13.2},
                 {{7.0, 24.0, 9.5}, 12.2},
                 {{11.5, 34.0, 3.0}, 11.4},
                 {{18.0, 40.5, -7.0}, 10.0},
                 {{27.0, 42.5, -15.0}, 8.4},
                 {{40.0, 41.0, -20.5}, 7.8}},
                kFar),
      CutVessel({{{15.0, 38.5, -3.0}, 8.6},
                 {{8.0, 37.0, -13.0}, 8.0},
                 {{-3.0, 36.5, -22.0}, 7.4},
                 {{-17.0, 38.0, -28.0}, 6.9},
                 {{-38.0, 40.0, -31.0}, 6.6}},
                kFar)};

  std::vector<CutVessel> veins_{
      // Superior and inferior vena cava.
      CutVessel({{{-36.0, 18.0, -12.0}, 10.5}, {{-37.0, 36.0, -10.0}, 8.8}, {{-36.0, 59.0, -9.0}, 8.6}},
                kFar),
      CutVessel({{{-33.0, -6.0, -16.0}, 11.5}, {{-31.0, -19.0, -19.0}, 10.2}, {{-30.0, -32.0, -20.0}, 10.2}},
                kFar),
      // Four pulmonary veins.
      CutVessel({{{24.0, 22.0, -30.0}, 6.4}, {{34.0, 25.0, -32.0}, 5.3}, {{43.0, 26.5, -33.0}, 5.3}}, kFar),
      CutVessel({{{24.0, 10.0, -32.0}, 6.4}, {{34.0, 7.0, -34.0}, 5.3}, {{42.0, 5.5, -35.0}, 5.3}}, kFar),
      CutVessel({{{-13.0, 20.0, -33.0}, 6.2}, {{-25.0, 21.0, -37.5}, 5.3}, {{-36.0, 21.5, -40.5}, 5.3}},
                kFar),
      CutVessel({{{-13.0, 9.0, -33.0}, 6.2}, {{-23.0, 3.5, -38.0}, 5.3}, {{-33.0, 0.5, -41.0}, 5.3}}, kFar)};
};

/// The vessels on the heart's surface. In millimetres.
class Coronaries final {
 public:
  /// @param branches false: only the four vessels in the grooves, placed deeper; for a coarse mesh
  Coronaries(const Chambers& chambers, bool branches) : chambers_(chambers), sunk_(branches ? 0.0 : 0.5) {
    const auto between_ventricles = [this](const Vec3& p) {
      return difference(chambers_.left_ventricle(p), chambers_.right_ventricle(p));
    };
    const auto at_atria = [this](const Vec3& p) {
      return difference(chambers_.ventricles(p), chambers_.atria(p));
    };
    lay({{20.0, 15.0, 14.0},
         {22.0, 2.0, 18.0},
         {24.0, -12.0, 20.0},
         {28.0, -28.0, 18.0},
         {33.0, -42.0, 16.0},
         {34.0, -50.0, 10.0}},
        2.1, 1.3, between_ventricles);
    const Tube anterior = vessels_.back();
    lay({{-16.5, 11.0, 21.0},
         {-25.0, 5.0, 20.0},
         {-34.0, -6.0, 12.0},
         {-36.0, -16.0, 0.0},
         {-28.0, -18.0, -14.0},
         {-14.0, -13.0, -26.0}},
        2.1, 1.8, at_atria);
    const Tube right = vessels_.back();
    lay({right.end().middle, {-6.0, -19.0, -23.0}, {14.0, -36.0, -12.0}, {26.0, -46.0, -2.0}}, 1.8, 1.1,
        between_ventricles);
    lay({anterior.knot_at(0.0).middle,
         {32.0, 13.0, 0.0},
         {36.0, 10.0, -12.0},
         {30.0, 4.0, -28.0},
         {16.0, -2.0, -36.0}},
        1.8, 1.2, at_atria);
    const Tube circumflex = vessels_.back();  // a copy: lay() may reallocate the list
    if (branches) lay_branches(anterior, right, circumflex);
  }

  [[nodiscard]] FieldValue on(FieldValue solid, const Vec3& p) const noexcept {
    if (solid.value > kReach || solid.value < -kReach) return solid;
    for (const Tube& vessel : vessels_) solid = unite(solid, vessel.at(p), kBlend);
    return solid;
  }
  [[nodiscard]] std::vector<VesselLine> lines() const {
    std::vector<VesselLine> lines;
    for (const Tube& vessel : vessels_) lines.push_back(line_of("coronary", vessel, 20));
    return lines;
  }

 private:
  static constexpr double kBlend = 1.5;
  static constexpr double kReach = 5.0;
  using Path = std::vector<Vec3>;

  void lay_branches(const Tube& anterior, const Tube& right, const Tube& circumflex) {
    sunk_ = 0.15;
    const auto anywhere = [](const Vec3&) { return FieldValue{}; };
    // Diagonal branches on the left ventricle.
    lay({anterior.knot_at(0.22).middle, {30.0, -2.0, 15.5}, {36.5, -11.0, 11.5}, {40.5, -22.0, 5.0}}, 1.5,
        0.9, anywhere);
    lay({anterior.knot_at(0.42).middle, {31.0, -18.0, 17.0}, {36.5, -27.0, 12.5}, {39.5, -36.0, 6.0}}, 1.4,
        0.9, anywhere);
    // Left marginal branches; the second is at the back.
    lay({circumflex.knot_at(0.42).middle, {42.0, -4.0, -10.0}, {42.0, -18.0, -8.0}, {40.0, -32.0, -4.0}}, 1.5,
        0.9, anywhere);
    lay({circumflex.knot_at(0.72).middle, {33.0, -6.0, -27.0}, {35.0, -19.0, -20.0}, {35.0, -31.0, -13.0}},
        1.4, 0.9, anywhere);
    // Right marginal branch, along the acute border, and a branch to the right ventricle's front wall.
    lay({right.knot_at(0.48).middle, {-26.0, -27.0, 10.0}, {-10.0, -38.0, 14.0}, {8.0, -42.0, 14.0}}, 1.5,
        0.9, anywhere);
    lay({right.knot_at(0.30).middle, {-26.0, -4.0, 25.0}, {-21.5, -12.0, 28.0}, {-19.0, -21.0, 28.0}}, 1.4,
        0.8, anywhere);
  }

  [[nodiscard]] static FieldValue difference(const FieldValue& a, const FieldValue& b) {
    return {a.value - b.value, a.gradient - b.gradient};
  }

  /// A tube on the surface along an approximate path, and along the groove where `seam` is 0. It rises from
  /// the wall over its first part and sinks into it over its last part.
  template <typename Seam>
  void lay(const Path& path, double first, double last, const Seam& seam) {
    std::vector<TubeKnot> rough;
    for (const Vec3& p : path) rough.push_back({p, 1.0});
    const Tube guide(rough, 1e6);
    const std::size_t count = 4 * (path.size() - 1);
    std::vector<Vec3> line;
    for (std::size_t i = 0; i <= count; ++i) {
      Vec3 p = guide.knot_at(static_cast<double>(i) / static_cast<double>(count)).middle;
      const bool in_seam = 6 * i > count;  // vessels reach their groove from elsewhere
      for (int step = 0; step < 40; ++step) {
        if (in_seam) p -= 0.7 * step_to(seam(p));
        p -= step_to(chambers_.at(p));
      }
      line.push_back(p);
    }
    for (int pass = 0; pass < 6; ++pass) smooth(line);
    std::vector<TubeKnot> knots;
    for (std::size_t i = 0; i <= count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count);
      const double radius = first + share * (last - first);
      constexpr double kRisen = 0.12;  // fraction of the path
      constexpr double kSinkFrom = 0.7;
      const double sink =
          std::max(1.0 - share / kRisen, std::max(0.0, share - kSinkFrom) / (1.0 - kSinkFrom));
      const double depth = (sunk_ + (1.25 - sunk_) * sink * sink) * radius;
      knots.push_back({line[i] - depth * chambers_.at(line[i]).gradient.normalized(), radius});
    }
    vessels_.emplace_back(knots, 2.0 * kBlend);
  }

  /// Smooths a line on the surface.
  void smooth(std::vector<Vec3>& line) const {
    std::vector<Vec3> even = line;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      even[i] = 0.25 * line[i - 1] + 0.5 * line[i] + 0.25 * line[i + 1];
      for (int step = 0; step < 3; ++step) even[i] -= step_to(chambers_.at(even[i]));
    }
    line = std::move(even);
  }

  [[nodiscard]] static Vec3 step_to(const FieldValue& f) {
    const double slope2 = f.gradient.squaredNorm();
    if (slope2 <= 1e-6) return Vec3::Zero();
    return std::clamp(f.value / slope2, -3.0, 3.0) * f.gradient;
  }

  const Chambers& chambers_;
  double sunk_;  // depth below the surface, relative to the radius
  std::vector<Tube> vessels_;
};

/// Without the details that are finer than the initial grid.
class SolidHeart final : public ImplicitSolid {
 public:
  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const FieldValue all = chambers_.at(p_m / kMillimetre);
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  Chambers chambers_;
};

/// The solid heart with the coronary vessels, and the lumens of the cut vessels as pits.
class Heart final : public ImplicitSolid {
 public:
  explicit Heart(bool branches) : coronaries_(chambers_, branches) {}

  [[nodiscard]] FieldValue at(const Vec3& p_m) const noexcept override {
    const Vec3 p = p_m / kMillimetre;
    FieldValue all = coronaries_.on(chambers_.at(p), p);
    for (const Ellipsoid& lumen : lumens_) {
      const double reach = lumen.half_axes.x() + lumen.half_axes.y();
      if ((p - lumen.middle).squaredNorm() > reach * reach) continue;
      all = subtract(all, lumen.at(p), CutVessel::kRim);
    }
    return {all.value * kMillimetre, all.gradient};
  }

 private:
  Chambers chambers_;
  Coronaries coronaries_;
  std::vector<Ellipsoid> lumens_ = chambers_.lumens();
};

}  // namespace

TriangleMesh make_heart(Detail detail) {
  const Bounds box{Vec3(-0.070, -0.070, -0.065), Vec3(0.070, 0.085, 0.050)};
  constexpr double kSpacing = 0.003;  // too coarse for the rims of the cut vessels, which remeshing adds
  const TriangleMesh start = polygonise(SolidHeart(), box, kSpacing);
  RemeshParameters goal{.vertices = kHeartVertices, .bend_radius = 0.012, .finest = 0.2};
  if (detail == Detail::k30k) goal = {.vertices = 15002, .bend_radius = 0.006, .finest = 0.2};
  if (detail == Detail::k75k)
    goal = {.vertices = 9377, .subdivisions = 1, .bend_radius = 0.005, .finest = 0.2};
  return remesh(Heart(detail != Detail::kPaper), start, goal);
}

std::vector<VesselLine> heart_vessels() {
  const Chambers chambers;
  std::vector<VesselLine> lines = Coronaries(chambers, true).lines();
  for (VesselLine& line : chambers.lines()) lines.push_back(std::move(line));
  return lines;
}

}  // namespace palpate::geometry
