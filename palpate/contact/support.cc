#include "palpate/contact/support.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "palpate/base/lanes.h"

namespace palpate::contact {
namespace {

/// The tangent plane of a contact and the cylinder about its axis, in the part's frame.
struct Plane {
  Vec3 point;
  Vec3 normal;
  double radius;  // R_ref

  /// 1 up to R_ref/2, 0 from R_ref on, smooth between. `rho_squared`: squared distance from the axis.
  [[nodiscard]] double taper(double rho_squared) const noexcept {
    const double inner = 0.5 * radius;
    if (rho_squared <= inner * inner) return 1.0;
    const double t = (std::sqrt(rho_squared) - inner) / inner;
    return t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
  }

  [[nodiscard]] double depth_of(const Vec3& p) const noexcept {
    const Vec3 offset = p - point;
    const double depth = -offset.dot(normal);
    return depth > 0.0 ? depth * taper(offset.squaredNorm() - depth * depth) : depth;
  }

  /// No point of a ball is deeper; 0 or less: none has a depth.
  [[nodiscard]] double most_in(const PartPoints::Cluster& ball) const noexcept {
    const Vec3 offset = ball.centre - point;
    const double height = offset.dot(normal);
    const double most = ball.radius - height;
    if (most <= 0.0) return 0.0;
    const double beside = std::sqrt(std::max(0.0, offset.squaredNorm() - height * height)) - ball.radius;
    return beside <= 0.0 ? most : most * taper(beside * beside);
  }
};

/// The same for four points at once, nearly: to leave out what is not deep.
struct PlaneLanes {
  Lanes x, y, z, nx, ny, nz, inner, inverse_inner;

  explicit PlaneLanes(const Plane& plane) noexcept
      : x(static_cast<float>(plane.point.x())),
        y(static_cast<float>(plane.point.y())),
        z(static_cast<float>(plane.point.z())),
        nx(static_cast<float>(plane.normal.x())),
        ny(static_cast<float>(plane.normal.y())),
        nz(static_cast<float>(plane.normal.z())),
        inner(static_cast<float>(0.5 * plane.radius)),
        inverse_inner(static_cast<float>(2.0 / plane.radius)) {}

  /// Writes the depths of a cluster's points, @return the greatest.
  float depths_of(const PartPoints& part, std::size_t begin, float* depths) const noexcept {
    const Lanes zero(0.0F);
    const Lanes one(1.0F);
    Lanes greatest(-1.0F);
    for (std::size_t i = begin; i < begin + PartPoints::kClusterSize; i += kLanes) {
      const Lanes dx = Lanes::load_unaligned(&part.near_x[i]) - x;
      const Lanes dy = Lanes::load_unaligned(&part.near_y[i]) - y;
      const Lanes dz = Lanes::load_unaligned(&part.near_z[i]) - z;
      const Lanes depth = zero - (dx * nx + dy * ny + dz * nz);
      const Lanes rho = xsimd::sqrt(xsimd::max(zero, dx * dx + dy * dy + dz * dz - depth * depth));
      const Lanes t = xsimd::min(one, xsimd::max(zero, (rho - inner) * inverse_inner));
      const Lanes tapered = depth * (one - t * t * (Lanes(3.0F) - (t + t)));
      const Lanes value = xsimd::min(depth, tapered);  // a depth of 0 or less stays as it is
      value.store_unaligned(depths + (i - begin));
      greatest = xsimd::max(greatest, value);
    }
    return largest_of(greatest);
  }
};

}  // namespace

void DepthScratch::reserve(std::size_t points) {
  const std::size_t clusters = (points + PartPoints::kClusterSize - 1) / PartPoints::kClusterSize;
  reached_.resize(clusters);
  depths_.resize(clusters * PartPoints::kClusterSize);
  deep_.resize(points);
}

Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius,
                   DepthScratch& scratch) noexcept {
  const Plane plane{point, normal, reference_radius};
  const PlaneLanes lanes(plane);
  // What single precision may be wrong by, and then some [m].
  const auto slack = static_cast<float>(part.rounding + 1e-6 * reference_radius);

  // The clusters that may have deep points, and of them the one that may have the deepest.
  std::size_t count = 0;
  std::size_t first = 0;
  for (const PartPoints::Cluster& group : part.groups) {
    if (plane.most_in(group) <= 0.0) continue;
    for (std::uint32_t c = group.begin; c < group.end; ++c) {
      const double most = plane.most_in(part.clusters[c]);
      if (most <= 0.0) continue;
      scratch.reached_[count] = {c, static_cast<float>(most) + slack, false};
      if (scratch.reached_[count].most > scratch.reached_[first].most) first = count;
      ++count;
    }
  }
  Support support;
  if (count == 0) return support;

  float deepest = 0.0F;
  const auto look_at = [&](DepthScratch::Reached& reached) {
    const std::size_t begin = std::size_t{reached.cluster} * PartPoints::kClusterSize;
    reached.most = lanes.depths_of(part, begin, &scratch.depths_[begin]);
    reached.looked_at = true;
    deepest = std::max(deepest, reached.most);
  };
  const auto band = static_cast<float>(kSupportBand);
  const auto floor = [&] { return std::max(deepest - band, 0.0F) - 2.0F * slack; };
  look_at(scratch.reached_[first]);
  for (std::size_t k = 0; k < count; ++k) {
    DepthScratch::Reached& reached = scratch.reached_[k];
    if (!reached.looked_at && reached.most >= floor()) look_at(reached);
  }

  // What may be in the band, exactly, in the order of the points.
  const float least = floor();
  std::size_t deep = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const DepthScratch::Reached& reached = scratch.reached_[k];
    if (!reached.looked_at || reached.most < least) continue;
    const PartPoints::Cluster& cluster = part.clusters[reached.cluster];
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      if (scratch.depths_[i] < least) continue;
      const double depth = plane.depth_of(part.point(i));
      scratch.deep_[deep++] = {static_cast<std::uint32_t>(i), depth};
      support.depth = std::max(support.depth, depth);
    }
  }
  if (support.depth <= 0.0) return support;

  const double width = std::min(kSupportBand, support.depth);
  double total = 0.0;
  for (std::size_t k = 0; k < deep; ++k) {
    const std::size_t i = scratch.deep_[k].point;
    const double share = 1.0 - (support.depth - scratch.deep_[k].depth) / width;
    if (share <= 0.0) continue;
    const double weight = part.area[i] * share;
    total += weight;
    support.mean += weight * part.point(i);
    support.tip_radius += weight * part.tip_radius[i];
    support.half_width += weight * part.half_width[i];
  }
  support.mean /= total;
  support.tip_radius /= total;
  support.half_width /= total;
  return support;
}

}  // namespace palpate::contact
