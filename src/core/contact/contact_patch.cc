#include "core/contact/contact_patch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/contact/contact_constants.h"

namespace palpate::contact {
namespace {

/// Finds the depths of a part's points behind the tangent plane at the proxy. Clusters that cannot hold a
/// point of the patch are skipped.
class DepthSearch final {
 public:
  DepthSearch(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius) noexcept
      : part_(part),
        point_(point),
        normal_(normal),
        steepness_(normal.cwiseAbs()),
        height_(point.dot(normal) + kBoundSlack),
        radius_(reference_radius) {}

  /// Measures every cluster that may have points within the band. @param first cluster to begin with; the one
  /// with the deepest point lets most others be skipped. The result does not depend on it.
  void run(std::uint32_t first) noexcept {
    measure(first);
    for (std::uint32_t c = 0; c < part_.clusters.size(); ++c) {
      if (c != first && may_count(part_.clusters[c])) measure(c);
    }
  }

  [[nodiscard]] ContactPatch patch() const noexcept {
    ContactPatch patch;
    if (deepest_ <= 0.0) return patch;
    patch.depth = deepest_;
    patch.cluster = deepest_cluster_;
    const double band = std::min(kPatchBand, deepest_);
    double total = 0.0;
    for (std::uint64_t clusters = measured_; clusters != 0; clusters &= clusters - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(clusters));
      for (std::uint32_t points = candidates_[c]; points != 0; points &= points - 1) {
        const std::size_t i = part_.clusters[c].begin + static_cast<std::size_t>(std::countr_zero(points));
        const double share = 1.0 - (deepest_ - depths_[i]) / band;
        if (share <= 0.0) continue;
        const double weight = part_.area[i] * share;
        patch.centroid += weight * part_.point(i);
        patch.tip_radius += weight * part_.tip_radius[i];
        patch.half_width += weight * part_.half_width[i];
        total += weight;
      }
    }
    patch.centroid /= total;
    patch.tip_radius /= total;
    patch.half_width /= total;
    return patch;
  }

 private:
  static constexpr std::size_t kMaxClusters = 64;  // one bit each in `measured_`
  static_assert(PartPoints::kMaxPoints <= kMaxClusters * PartPoints::kClusterSize);

  /// 1 up to R_ref/2 from the axis, 0 from R_ref, smooth between. @param rho_squared squared distance from
  /// the axis
  [[nodiscard]] double taper(double rho_squared) const noexcept {
    const double inner = 0.5 * radius_;
    if (rho_squared <= inner * inner) return 1.0;
    const double t = (std::sqrt(rho_squared) - inner) / inner;
    return t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
  }

  /// Whether a point of the cluster may be within the band below the deepest point found so far.
  [[nodiscard]] bool may_count(const PartPoints::Cluster& cluster) const noexcept {
    const double behind = cluster.half_size.dot(steepness_) - cluster.centre.dot(normal_) + height_;
    if (behind <= least_) return false;
    const Vec3 offset = cluster.centre - point_;
    const double along = offset.dot(normal_);
    const double rho = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along)) - cluster.radius;
    return rho <= 0.0 || behind * taper(rho * rho) > least_;
  }

  void measure(std::uint32_t c) noexcept {
    const PartPoints::Cluster& cluster = part_.clusters[c];
    measured_ |= std::uint64_t{1} << c;
    const double* const x = part_.x.data() + cluster.begin;
    const double* const y = part_.y.data() + cluster.begin;
    const double* const z = part_.z.data() + cluster.begin;
    const Vec3 p = point_;
    const Vec3 n = normal_;
    double* const __restrict depths = depths_.data() + cluster.begin;
    const std::size_t count = cluster.end - cluster.begin;
    for (std::size_t i = 0; i < count; ++i) {
      depths[i] = -((x[i] - p.x()) * n.x() + ((y[i] - p.y()) * n.y() + (z[i] - p.z()) * n.z()));
    }
    std::uint32_t candidates = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (depths[i] <= least_) continue;  // the taper only makes it smaller
      depths[i] *= taper((part_.point(cluster.begin + i) - p).squaredNorm() - depths[i] * depths[i]);
      candidates |= std::uint32_t{1} << i;
      if (depths[i] <= deepest_) continue;
      deepest_ = depths[i];
      deepest_cluster_ = c;
      least_ = std::max(0.0, deepest_ - kPatchBand - kBoundSlack);
    }
    candidates_[c] = candidates;
  }

  const PartPoints& part_;
  Vec3 point_;      // of the tangent plane
  Vec3 normal_;     // of the tangent plane
  Vec3 steepness_;  // absolute values of normal_
  double height_;   // of the plane above the origin plus kBoundSlack [m]
  double radius_;   // R_ref [m]
  double deepest_ = 0.0;
  double least_ = 0.0;  // points must be deeper than this to count [m]
  std::uint32_t deepest_cluster_ = 0;
  std::uint64_t measured_ = 0;  // one bit per cluster
  std::array<std::uint32_t, kMaxClusters>
      candidates_;  // per measured cluster: one bit per point that may count
  std::array<double, kMaxClusters * PartPoints::kClusterSize> depths_;  // [m], of measured clusters
};

}  // namespace

ContactPatch contact_patch_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                              double reference_radius, std::uint32_t guess) noexcept {
  DepthSearch search(part, point, normal, reference_radius);
  search.run(guess);
  return search.patch();
}

}  // namespace palpate::contact
