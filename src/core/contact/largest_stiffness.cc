#include "core/contact/largest_stiffness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/contact/state.h"

namespace palpate::contact {
namespace {

constexpr int kDepths = 8;             // of one position
constexpr int kAround = 6;             // places on a ring
constexpr double kDepthStep = 1e-5;    // m, of a difference quotient
constexpr double kPlaceStep = 0.2e-3;  // m, of a difference quotient: less than any inclusion's radius
constexpr double kTwoPi = 6.283185307179586;
// Radii of the rings, over the inclusion's depth. Its extra energy falls to a half at about 0.5.
constexpr std::array kRings{0.35, 0.7, 1.1};

/// The deepest point within reach of tissue that is `factor` times as stiff.
model::SpringLaw::LayerState deepest(const model::SpringLaw& law, const StiffnessReach& reach,
                                     double factor) noexcept {
  constexpr double kJustBelow = 1.0 - 1e-12;  // at the law's largest force its tangent is zero
  const double force =
      std::min({reach.max_force / factor, law.force_at(reach.max_depth).force, law.max_force() * kJustBelow});
  return law.deformation_under(force);
}

/// Largest absolute eigenvalue of the symmetric matrix (a b; b d).
double largest_eigenvalue(double a, double b, double d) noexcept {
  const double half = 0.5 * (a - d);
  return std::abs(0.5 * (a + d)) + std::sqrt(half * half + b * b);
}

Vec3 along(const Vec3& normal, const Vec3& force) noexcept { return force - force.dot(normal) * normal; }

/// A position and its neighbours on two axes of the tangent plane.
struct Neighbourhood {
  Vec3 normal;
  std::array<Vec3, 2> axes;
  TissueAt here;
  std::array<TissueAt, 4> around;  // before and after on the first axis, then on the second

  /// Stiffness at a depth [N/m]; 0 where the force exceeds the reach.
  [[nodiscard]] double stiffness(const model::SpringLaw& law, double depth, double max_force) const {
    const TissueAt::Force now = here.force_at(law, depth);
    if (!(now.normal <= max_force)) return 0.0;
    const TissueAt::Force deeper = here.force_at(law, depth + kDepthStep);
    const double by_depth = (deeper.normal - now.normal) / kDepthStep;
    const double mixed = along(normal, deeper.lateral_S - now.lateral_S).norm() / kDepthStep;
    const auto change = [&](std::size_t axis) {
      const Vec3 before = around[2 * axis].force_at(law, depth).lateral_S;
      return Vec3((around[2 * axis + 1].force_at(law, depth).lateral_S - before) / (2.0 * kPlaceStep));
    };
    const Vec3 first = change(0);
    const Vec3 second = change(1);
    const double by_place = largest_eigenvalue(
        axes[0].dot(first), 0.5 * (axes[0].dot(second) + axes[1].dot(first)), axes[1].dot(second));
    return largest_eigenvalue(by_depth, mixed, by_place);
  }
};

/// Searches the places of one tool.
class Search final {
 public:
  Search(const World::Data& world, const ToolTissue& tissue, const StiffnessReach& reach)
      : world_(world),
        tissue_(tissue),
        law_(reach.direction == model::Direction::kPull ? tissue.laws.pull : tissue.laws.press),
        reach_(reach),
        deepest_(deepest(law_, reach, 1.0).depth),
        largest_(largest_tangent(law_, reach)) {}

  /// At the surface point nearest to `point`.
  void at(const Vec3& point) {
    const geometry::NearestPoint nearest = world_.surface.nearest(point, -1);
    const SurfacePoint place{nearest.point, nearest.triangle};
    const Vec3 normal = world_.surface.normal_at(place);
    const auto [first, second] = axes_of(normal);
    const auto step_to = [&](const Vec3& step) {
      return TissueAt(tissue_, world_.surface.walk(place, kPlaceStep * step, normal));
    };
    const Neighbourhood near{normal,
                             {first, second},
                             TissueAt(tissue_, place),
                             {step_to(-first), step_to(first), step_to(-second), step_to(second)}};
    for (int i = 1; i <= kDepths; ++i) {
      const double depth = deepest_ * i / kDepths;
      const double uniform = law_.force_at(depth).force;
      const double force = near.here.force_at(law_, depth).normal;
      largest_ = std::max(largest_, near.stiffness(law_, depth, reach_.max_force));
      // A layer may be narrower than the step of a depth: its whole tangent counts.
      if (uniform > 0.0 && force > uniform) largest_ = std::max(largest_, of_layers(force / uniform));
    }
  }

  /// Above an inclusion.
  void above(const InclusionNow& inclusion) {
    const Vec3 top = world_.surface.nearest(inclusion.centre_S, -1).point;
    const double depth = std::sqrt(inclusion.depth_squared);
    const Vec3 outward = depth > 0.0 ? Vec3((top - inclusion.centre_S) / depth) : Vec3(Vec3::UnitZ());
    const auto [first, second] = axes_of(outward);
    at(top);
    for (const double ring : kRings) {
      for (int i = 0; i < kAround; ++i) {
        const auto [sine, cosine] = portable::sin_cos(kTwoPi * i / kAround);
        at(top + ring * depth * (cosine * first + sine * second));
      }
    }
  }

  /// Everywhere on a stiffness map.
  void map() {
    const auto triangles = static_cast<std::int32_t>(world_.surface.mesh().triangles.size());
    for (std::int32_t triangle = 0; triangle < triangles; ++triangle) {
      const StiffnessMap::Steepness one = tissue_.map.steepness_of(triangle);
      const model::SpringLaw::LayerState state = deepest(law_, reach_, one.value);
      largest_ = std::max(largest_, largest_eigenvalue(one.value * state.stiffness, one.slope * state.force,
                                                       one.curvature * law_.energy_at(state.depth)));
    }
  }

  [[nodiscard]] double largest() const noexcept { return largest_; }

 private:
  [[nodiscard]] static std::pair<Vec3, Vec3> axes_of(const Vec3& normal) noexcept {
    const Vec3 first = normal.unitOrthogonal();
    return {first, normal.cross(first)};
  }

  [[nodiscard]] double of_layers(double factor) const noexcept {
    return factor * deepest(law_, reach_, factor).stiffness;
  }

  const World::Data& world_;
  const ToolTissue& tissue_;
  const model::SpringLaw& law_;
  StiffnessReach reach_;
  double deepest_;  // m
  double largest_;  // N/m
};

/// The inclusions at rest, and where each is nearest to the surface.
std::array<InclusionState, 2> ends_of_pulses(const World& world,
                                             const std::vector<model::Inclusion>& inclusions) {
  std::array<InclusionState, 2> ends;
  for (std::size_t i = 0; i < inclusions.size(); ++i) {
    PlacedInclusion placed = placed_inclusion(world, i, inclusions[i]);
    ends[0].add(placed);
    placed.inclusion.centre_S += placed.inclusion.pulse * placed.outward_S;
    placed.depth -= placed.inclusion.pulse;
    placed.inclusion.pulse = 0.0;
    ends[1].add(placed);
  }
  return ends;
}

}  // namespace

double largest_tangent(const model::SpringLaw& law, const StiffnessReach& reach) {
  return std::max(law.force_at(0.0).stiffness, deepest(law, reach, 1.0).stiffness);
}

double largest_stiffness(const World& world, const TissueLaws& laws,
                         const std::vector<model::Inclusion>& inclusions, std::size_t tool,
                         const StiffnessReach& reach) {
  const World::Data& data = world.data();
  double largest = 0.0;
  for (const InclusionState& state : ends_of_pulses(world, inclusions)) {
    const ToolTissue tissue{laws, state.now(), data.map, data.tools[tool].tip_radius};
    Search search(data, tissue, reach);
    if (!data.map.empty()) search.map();
    for (std::size_t i = 0; i < state.now().size(); ++i) {
      search.above(state.now()[i]);
      for (std::size_t j = 0; j < i; ++j) {
        search.at(0.5 * (state.now()[i].centre_S + state.now()[j].centre_S));
      }
    }
    largest = std::max(largest, search.largest());
  }
  return largest;
}

}  // namespace palpate::contact
