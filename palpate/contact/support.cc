#include "palpate/contact/support.h"

#include <algorithm>
#include <cmath>

namespace palpate::contact {
namespace {

/// 1 up to R_ref/2, 0 from R_ref on, smooth between. `rho_squared`: squared distance from the axis.
double taper(double rho_squared, double reference_radius) noexcept {
  const double inner = 0.5 * reference_radius;
  if (rho_squared <= inner * inner) return 1.0;
  const double t = (std::sqrt(rho_squared) - inner) / inner;
  return t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
}

bool out_of_reach(const PartPoints::Cluster& cluster, const Vec3& point, const Vec3& normal,
                  double reference_radius) noexcept {
  const Vec3 offset = cluster.centre - point;
  const double height = offset.dot(normal);
  if (height > cluster.radius) return true;
  const double reach = reference_radius + cluster.radius;
  return offset.squaredNorm() - height * height > reach * reach;
}

}  // namespace

Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius,
                   DepthScratch& scratch) noexcept {
  Support support;
  for (const PartPoints::Cluster& cluster : part.clusters) {
    if (out_of_reach(cluster, point, normal, reference_radius)) continue;
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      const Vec3 offset = part.point(i) - point;
      double depth = -offset.dot(normal);
      if (depth > 0.0) {
        depth *= taper(offset.squaredNorm() - depth * depth, reference_radius);
        support.depth = std::max(support.depth, depth);
      }
      scratch[i] = depth;
    }
  }
  if (support.depth <= 0.0) return support;

  const double band = std::min(kSupportBand, support.depth);
  double total = 0.0;
  for (const PartPoints::Cluster& cluster : part.clusters) {
    if (out_of_reach(cluster, point, normal, reference_radius)) continue;
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      const double share = 1.0 - (support.depth - scratch[i]) / band;
      if (share <= 0.0) continue;
      const double weight = part.area[i] * share;
      total += weight;
      support.mean += weight * part.point(i);
      support.tip_radius += weight * part.tip_radius[i];
      support.half_width += weight * part.half_width[i];
    }
  }
  support.mean /= total;
  support.tip_radius /= total;
  support.half_width /= total;
  return support;
}

}  // namespace palpate::contact
