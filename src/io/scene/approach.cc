#include "io/scene/approach.h"

#include <algorithm>
#include <cmath>

#include "core/base/index.h"
#include "core/base/portable_math.h"

namespace palpate::scene {
namespace {

constexpr double kLeastRadius = 5e-3;  // m, of the region around a touch; half the usual reference radius
constexpr double kGreatestRadius = 10e-3;
constexpr double kDeepEnough = 0.95;   // of the requested depth
constexpr double kSure = 1.1;          // of the requested depth: a tool is wider than its tip
constexpr double kThickEnough = 1.25;  // of the requested depth
constexpr double kFacing =
    0.35;                      // cosine of about 70 degrees: faces with a larger angle belong to another side
constexpr double kFlat = 0.7;  // least flatness; a sphere of the region's radius has 0.78
constexpr double kBroad = 0.75;   // least breadth; a strip as wide as the region's radius has 0.75
constexpr double kSteep = 0.36;   // tangent of 20 degrees: tool points above this cone must stay outside
constexpr double kBeside = 2e-3;  // m, above the touch: tool points below this height may press too
constexpr double kFineTriangles = 2e4;  // triangles of the refined organ
constexpr double kPlaces = 400.0;       // number of sample points
constexpr double kFromAbove = 0.05;     // bonus in the rank of an approach from above

geometry::TriangleMesh fine_mesh(const geometry::TriangleMesh& organ) {
  double area = 0.0;
  for (const geometry::Triangle& t : organ.triangles)
    area += 0.5 * geometry::area_vector_doubled(organ, t).norm();
  // Refinement leaves triangles of about a quarter of the squared longest edge.
  return geometry::refine(organ, std::max(kLeastRadius / 2.0, std::sqrt(4.0 * area / kFineTriangles)));
}

}  // namespace

Quat turn_from_down(const Vec3& direction) noexcept {
  const double half = 1.0 - direction.z();
  if (half < 1e-9) return {0.0, 1.0, 0.0, 0.0};
  return Quat(half, direction.y(), -direction.x(), 0.0).normalized();
}

ApproachFinder::ApproachFinder(const geometry::TriangleMesh& organ, const geometry::SignedDistance& surface,
                               const HangingTool& tool)
    : surface_(surface),
      tool_(tool),
      length_(geometry::bounds(organ).size().norm()),
      own_(fine_mesh(organ)),
      is_fine_(surface.is_of(own_)),
      fine_(is_fine_ ? surface.mesh() : own_),
      own_neighbours_(is_fine_ ? Neighbours() : geometry::edge_neighbours(own_)),
      neighbours_(is_fine_ ? surface.neighbours() : own_neighbours_),
      lowest_(geometry::cell_at(geometry::bounds(fine_).low, kLeastRadius)) {
  if (is_fine_) own_ = {};
  middles_.reserve(fine_.triangles.size());
  areas_.reserve(fine_.triangles.size());
  cells_.reserve(fine_.triangles.size());
  for (const geometry::Triangle& t : fine_.triangles) {
    middles_.push_back((fine_.vertices[at(t[0])] + fine_.vertices[at(t[1])] + fine_.vertices[at(t[2])]) /
                       3.0);
    areas_.push_back(geometry::area_vector_doubled(fine_, t));
    cells_.emplace_back(key_of(geometry::cell_at(middles_.back(), kLeastRadius)),
                        static_cast<std::int32_t>(cells_.size()));
  }
  std::sort(cells_.begin(), cells_.end());
}

std::uint64_t ApproachFinder::key_of(const geometry::Cell& cell) const {
  constexpr std::int64_t kMost = (1 << 21) - 1;  // 10 km
  std::uint64_t key = 0;
  for (std::size_t k = 0; k < 3; ++k)
    key = key << 21 | static_cast<std::uint64_t>(std::clamp<std::int64_t>(cell[k] - lowest_[k], 0, kMost));
  return key;
}

/// The smallest distance [m] of the tip to the surface at `depth` behind the touch. The proxy follows the
/// surface downhill, so only triangles that are connected to the touch and not farther from the tip count.
/// The search ends as soon as the depth is too small.
double ApproachFinder::depth_reached(const Approach& approach, std::int32_t start, double depth) const {
  constexpr double kBump = 0.2e-3;  // m, tolerance of the distance
  const Vec3 tip = approach.touch + depth * approach.direction;
  const auto distance_of = [&](std::size_t t) {
    const geometry::Triangle& corners = fine_.triangles[t];
    const Vec3 point = geometry::nearest_on_triangle(
        tip, fine_.vertices[at(corners[0])], fine_.vertices[at(corners[1])], fine_.vertices[at(corners[2])]);
    return (point - tip).norm();
  };
  std::vector<std::int32_t> queue{start};
  std::vector<bool> seen(middles_.size(), false);
  seen[at(queue.front())] = true;
  double nearest = depth;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const double distance = distance_of(at(queue[i]));
    if (distance > depth + kBump && i > 0) continue;
    nearest = std::min(nearest, distance);
    if (nearest < kDeepEnough * depth) break;
    for (const std::int32_t next : neighbours_[at(queue[i])]) {
      if (next < 0 || seen[at(next)]) continue;
      seen[at(next)] = true;
      if (-areas_[at(next)].dot(approach.direction) >= kFacing * areas_[at(next)].norm())
        queue.push_back(next);
    }
  }
  return nearest;
}

double ApproachFinder::thickness(const Approach& approach, double enough) const {
  constexpr double kStep = 0.1e-3;  // m, at least
  double behind = kStep;
  while (behind < enough) {
    const double distance = surface_.nearest(approach.touch + behind * approach.direction).distance;
    if (distance >= 0.0 && behind > 5.0 * kStep) break;
    behind += std::max(kStep, std::abs(distance));
  }
  return std::min(behind, enough);
}

bool ApproachFinder::is_free(const Approach& approach, double depth) const {
  // The straight line from far outside must meet the organ first at the touch, so that a shaft longer than
  // its mesh has room too.
  const double far_off = length_ + tool_.clearance;
  const auto entry = surface_.first_entry(approach.touch - far_off * approach.direction,
                                          approach.touch + kBeside * approach.direction);
  if (entry && entry->fraction * (far_off + kBeside) < far_off - kBeside) return false;
  const Quat turn = turn_from_down(approach.direction);
  for (const double height : {tool_.clearance, 0.0, -depth}) {
    const bool starts = height == tool_.clearance;
    for (const Vec3& point : tool_.points) {
      const double low = kBeside + kSteep * std::hypot(point.x(), point.y());
      if (!starts && point.z() + height < low) continue;
      const Vec3 placed = approach.touch + turn * point - height * approach.direction;
      if (surface_.nearest(placed).distance <= (starts ? kBeside : 0.0)) return false;
    }
  }
  return true;
}

bool ApproachFinder::LocalShape::is_flat() const { return flatness >= kFlat && breadth >= kBroad; }

ApproachFinder::LocalShape ApproachFinder::local_shape(const Vec3& point, const Vec3& outward,
                                                       double depth) const {
  const double radius = std::clamp(depth, kLeastRadius, kGreatestRadius);
  Vec3 sum = Vec3::Zero();
  Vec3 facing = Vec3::Zero();
  double all = 0.0;
  const auto add = [&](std::size_t t) {
    const double share = 1.0 - (middles_[t] - point).squaredNorm() / (radius * radius);
    if (share <= 0.0) return;
    const double area = areas_[t].norm();
    const double along = areas_[t].dot(outward);
    if (along < -kFacing * area) return;
    sum += share * areas_[t];
    all += share * area;
    if (along > kFacing * area) facing += share * areas_[t];
  };
  geometry::Cell low = geometry::cell_at(point.array() - radius, kLeastRadius);
  for (std::size_t k = 0; k < 3; ++k) low[k] = std::max(low[k], lowest_[k]);
  const geometry::Cell high = geometry::cell_at(point.array() + radius, kLeastRadius);
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      const std::uint64_t last = key_of({x, y, high[2]});
      auto cell = std::lower_bound(cells_.begin(), cells_.end(), std::pair{key_of({x, y, low[2]}), 0});
      for (; cell != cells_.end() && cell->first <= last; ++cell) add(at(cell->second));
    }
  }
  if (!(facing.norm() > 0.0)) return {outward, 0.0, 0.0};
  const double disc =
      portable::kPi * radius * radius;  // twice the area of a flat disc, times the mean weight 1/2
  return {facing.normalized(), sum.norm() / all, std::min(1.0, facing.norm() / disc)};
}

ApproachCheck ApproachFinder::check_from(const Approach& approach, std::int32_t start, double depth) const {
  const double enough = kThickEnough * depth;
  ApproachCheck result;
  result.thickness = thickness(approach, enough);
  result.square = depth_reached(approach, start, kSure * depth) >= kDeepEnough * kSure * depth &&
                  is_free(approach, depth);
  result.thick = result.square && result.thickness >= enough;
  return result;
}

ApproachCheck ApproachFinder::check(const Approach& approach, double depth) const {
  if (!local_shape(approach.touch, -approach.direction, depth).is_flat()) return {};
  const auto nearer = [&](const Vec3& a, const Vec3& b) {
    return (a - approach.touch).squaredNorm() < (b - approach.touch).squaredNorm();
  };
  const auto start = std::min_element(middles_.begin(), middles_.end(), nearer) - middles_.begin();
  return check_from(approach, static_cast<std::int32_t>(start), depth);
}

CheckedApproach ApproachFinder::best(const Vec3& up, double depth) const {
  struct Candidate {
    Approach approach;
    std::int32_t triangle = 0;
    double rank = 0.0;
  };
  double whole = 0.0;
  for (const Vec3& area : areas_) whole += area.norm();
  std::vector<Candidate> candidates;
  double passed = 0.0;
  double next = 0.0;
  for (std::size_t t = 0; t < middles_.size(); ++t) {
    passed += areas_[t].norm();
    if (passed < next) continue;
    next += whole / kPlaces;
    const LocalShape shape = local_shape(middles_[t], areas_[t].normalized(), depth);
    if (!shape.is_flat()) continue;
    candidates.push_back({{middles_[t], -shape.normal},
                          static_cast<std::int32_t>(t),
                          shape.flatness * shape.breadth + kFromAbove * shape.normal.dot(up)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.rank > b.rank; });
  CheckedApproach best;
  for (const Candidate& candidate : candidates) {
    const bool too_thin = thickness(candidate.approach, kThickEnough * depth) < kThickEnough * depth;
    if (too_thin && best.result.square) continue;  // cannot be better
    const ApproachCheck result = check_from(candidate.approach, candidate.triangle, depth);
    if (result.thick || (result.square && !best.result.square)) best = {candidate.approach, result};
    if (result.thick) break;
  }
  return best;
}

}  // namespace palpate::scene
