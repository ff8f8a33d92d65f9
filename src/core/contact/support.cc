#include "core/contact/support.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace palpate::contact {
namespace {

constexpr double kBoundSlack = 1e-12;  // m: rounding of a cluster's bound against its points' depths

/// Depths of a part's points behind the tangent plane of a contact, as far as they may carry it.
class DepthSearch final {
 public:
  DepthSearch(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius) noexcept
      : part_(part),
        point_(point),
        normal_(normal),
        steepness_(normal.cwiseAbs()),
        radius_(reference_radius) {}

  /// Measures every cluster that may have points within the band. @param first the one to begin with: any
  /// will do, that with the deepest point leaves most of the others out
  void run(std::uint32_t first) noexcept {
    measure(first);
    for (std::uint32_t c = 0; c < part_.clusters.size(); ++c) {
      if (c != first && may_count(part_.clusters[c])) measure(c);
    }
  }

  [[nodiscard]] Support support() const noexcept {
    Support support;
    if (deepest_ <= 0.0) return support;
    support.depth = deepest_;
    support.cluster = deepest_cluster_;
    const double band = std::min(kSupportBand, deepest_);
    double total = 0.0;
    for (std::uint64_t left = measured_; left != 0; left &= left - 1) {
      const PartPoints::Cluster& cluster = part_.clusters[static_cast<std::size_t>(std::countr_zero(left))];
      for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
        if (depths_[i] < least_ - kBoundSlack) continue;  // spares the division
        const double share = 1.0 - (deepest_ - depths_[i]) / band;
        if (share <= 0.0) continue;
        const double weight = part_.area[i] * share;
        support.mean += weight * part_.point(i);
        support.tip_radius += weight * part_.tip_radius[i];
        support.half_width += weight * part_.half_width[i];
        total += weight;
      }
    }
    support.mean /= total;
    support.tip_radius /= total;
    support.half_width /= total;
    return support;
  }

 private:
  static constexpr std::size_t kMostClusters = 64;  // a bit of `measured_` each
  static_assert(PartPoints::kMostPoints <= kMostClusters * PartPoints::kClusterSize);

  /// 1 up to R_ref/2 from the axis, 0 from R_ref on, smooth between. @param rho_squared squared distance from
  /// it
  [[nodiscard]] double taper(double rho_squared) const noexcept {
    const double inner = 0.5 * radius_;
    if (rho_squared <= inner * inner) return 1.0;
    const double t = (std::sqrt(rho_squared) - inner) / inner;
    return t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
  }

  /// Whether a point of the cluster may be within the band of the deepest so far.
  [[nodiscard]] bool may_count(const PartPoints::Cluster& cluster) const noexcept {
    const Vec3 offset = cluster.centre - point_;
    const double height = offset.dot(normal_);
    const double behind = cluster.half_size.dot(steepness_) - height + kBoundSlack;
    if (behind <= least_) return false;
    const double rho = std::sqrt(std::max(0.0, offset.squaredNorm() - height * height)) - cluster.radius;
    return rho <= 0.0 || behind * taper(rho * rho) > least_;
  }

  void measure(std::uint32_t c) noexcept {
    const PartPoints::Cluster& cluster = part_.clusters[c];
    measured_ |= std::uint64_t{1} << c;
    const double* const x = part_.x.data();
    const double* const y = part_.y.data();
    const double* const z = part_.z.data();
    const Vec3 p = point_;
    const Vec3 n = normal_;
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      depths_[i] = -((x[i] - p.x()) * n.x() + ((y[i] - p.y()) * n.y() + (z[i] - p.z()) * n.z()));
    }
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      if (depths_[i] <= least_) continue;  // with the taper still more so
      depths_[i] *= taper((part_.point(i) - p).squaredNorm() - depths_[i] * depths_[i]);
      if (depths_[i] <= deepest_) continue;
      deepest_ = depths_[i];
      deepest_cluster_ = c;
      least_ = std::max(0.0, deepest_ - kSupportBand);
    }
  }

  const PartPoints& part_;
  Vec3 point_;      // of the plane
  Vec3 normal_;     // of the plane
  Vec3 steepness_;  // its components' sizes
  double radius_;   // R_ref [m]
  double deepest_ = 0.0;
  double least_ = 0.0;  // points that are no deeper do not count [m]
  std::uint32_t deepest_cluster_ = 0;
  std::uint64_t measured_ = 0;                                           // one bit a cluster
  std::array<double, kMostClusters * PartPoints::kClusterSize> depths_;  // [m], of clusters measured
};

}  // namespace

Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal, double reference_radius,
                   std::uint32_t guess) noexcept {
  DepthSearch search(part, point, normal, reference_radius);
  search.run(guess);
  return search.support();
}

}  // namespace palpate::contact
