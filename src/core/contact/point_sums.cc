#include "core/contact/point_sums.h"

#include <algorithm>
#include <array>
#include <limits>

#include <immintrin.h>

#include "core/base/lanes.h"

namespace palpate::contact {
namespace {

using Weighed = PartPoints::Weighed;

/// Four points of a part.
using FourPoints = std::array<const Weighed*, 4>;

/// The four points from `from` on, of which there are `left`: the last one stands in for those behind it.
[[gnu::always_inline]] inline FourPoints four_from(const Weighed* weighed, const std::uint16_t* from,
                                                   std::size_t left) noexcept {
  if (left >= 4) return {weighed + from[0], weighed + from[1], weighed + from[2], weighed + from[3]};
  const Weighed* const second = weighed + from[left > 1 ? 1 : 0];
  const Weighed* const third = left > 2 ? weighed + from[2] : second;
  return {weighed + from[0], second, third, third};
}

}  // namespace

namespace by_two {
namespace {

/// Weighted sums over points.
struct Sums {
  Pair xy = Pair(0.0);
  Pair z_radius = Pair(0.0);
  Pair weight_width = Pair(0.0);

  void add(const Weighed& point, const Pair& weight) noexcept {
    xy += weight * Pair::load_aligned(&point.x);
    z_radius += weight * Pair::load_aligned(&point.z);
    weight_width += weight * Pair::load_aligned(&point.one);
  }
};

}  // namespace

double full_depths(const PartPoints& part, const Vec3& point, const Vec3& normal,
                   std::span<const std::uint16_t> points, double* depths) noexcept {
  const Pair x(point.x()), y(point.y()), z(point.z());
  const Pair nx(normal.x()), ny(normal.y()), nz(normal.z());
  const Weighed* const weighed = part.weighed.data();
  Pair deepest(0.0);
  const auto two = [&](std::size_t first, std::size_t second) {
    const Weighed& a = weighed[points[first]];
    const Weighed& b = weighed[points[second]];
    const Pair dx = pair_of(a.x, b.x) - x;
    const Pair dy = pair_of(a.y, b.y) - y;
    const Pair dz = pair_of(a.z, b.z) - z;
    // Sums of three run as Eigen's do, so that they round alike.
    const Pair found = -(dx * nx + (dy * ny + dz * nz));
    found.store_unaligned(depths + first);
    deepest = max(found, deepest);
  };
  std::size_t k = 0;
  for (; k + kPair <= points.size(); k += kPair) two(k, k + 1);
  if (k < points.size()) two(k, k);
  return largest_of(deepest);
}

Support sum_up(const PartPoints& part, std::span<const std::uint16_t> points, double* depths,
               double depth) noexcept {
  Support support;
  if (depth <= 0.0) return support;
  support.depth = depth;
  const Weighed* const weighed = part.weighed.data();
  const Pair greatest(depth);
  const Pair width(std::min(kSupportBand, depth));
  Sums sums;
  // A point outside the band adds nothing: a weight of 0 changes no bit, and often costs less than to ask.
  const auto add_two = [&](std::size_t first, std::size_t second) {
    const Pair share = Pair(1.0) - (greatest - Pair::load_unaligned(depths + first)) / width;
    if (lanes_of(share > Pair(0.0)) == 0) return;
    const Weighed& a = weighed[points[first]];
    const Weighed& b = weighed[points[second]];
    const Pair weight = pair_of(a.area, b.area) * max(share, Pair(0.0));
    sums.add(a, Pair(weight.get(0)));
    if (first != second) sums.add(b, Pair(weight.get(1)));
  };
  std::size_t k = 0;
  for (; k + kPair <= points.size(); k += kPair) add_two(k, k + 1);
  if (k < points.size()) add_two(k, k);
  const double total = sums.weight_width.get(0);
  support.mean = Vec3(sums.xy.get(0), sums.xy.get(1), sums.z_radius.get(0)) / total;
  support.tip_radius = sums.z_radius.get(1) / total;
  support.half_width = sums.weight_width.get(1) / total;
  return support;
}

}  // namespace by_two

// What AVX2 is needed for.
namespace by_four {
namespace {

[[gnu::target("avx2")]] double full_depths(const PartPoints& part, const Vec3& point, const Vec3& normal,
                                           std::span<const std::uint16_t> points, double* depths) noexcept {
  const Weighed* const weighed = part.weighed.data();
  const __m256d x = _mm256_set1_pd(point.x());
  const __m256d y = _mm256_set1_pd(point.y());
  const __m256d z = _mm256_set1_pd(point.z());
  const __m256d nx = _mm256_set1_pd(normal.x());
  const __m256d ny = _mm256_set1_pd(normal.y());
  const __m256d nz = _mm256_set1_pd(normal.z());
  const __m256d minus = _mm256_set1_pd(-0.0);
  __m256d deepest = _mm256_setzero_pd();
  for (std::size_t k = 0; k < points.size(); k += 4) {
    const FourPoints four = four_from(weighed, points.data() + k, points.size() - k);
    // Rows of x, y, z and something else become columns.
    const __m256d a = _mm256_load_pd(&four[0]->x);
    const __m256d b = _mm256_load_pd(&four[1]->x);
    const __m256d c = _mm256_load_pd(&four[2]->x);
    const __m256d d = _mm256_load_pd(&four[3]->x);
    const __m256d xz_ab = _mm256_unpacklo_pd(a, b);
    const __m256d xz_cd = _mm256_unpacklo_pd(c, d);
    const __m256d y_ab = _mm256_unpackhi_pd(a, b);
    const __m256d y_cd = _mm256_unpackhi_pd(c, d);
    const __m256d dx = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x20), x);
    const __m256d dy = _mm256_sub_pd(_mm256_permute2f128_pd(y_ab, y_cd, 0x20), y);
    const __m256d dz = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x31), z);
    const __m256d height =
        _mm256_add_pd(_mm256_mul_pd(dx, nx), _mm256_add_pd(_mm256_mul_pd(dy, ny), _mm256_mul_pd(dz, nz)));
    const __m256d found = _mm256_xor_pd(height, minus);
    _mm256_storeu_pd(depths + k, found);
    deepest = _mm256_max_pd(found, deepest);
  }
  const __m128d two = _mm_max_pd(_mm256_castpd256_pd128(deepest), _mm256_extractf128_pd(deepest, 1));
  return std::max(_mm_cvtsd_f64(two), _mm_cvtsd_f64(_mm_unpackhi_pd(two, two)));
}

[[gnu::target("avx2")]] Support sum_up(const PartPoints& part, std::span<const std::uint16_t> points,
                                       double* depths, double depth) noexcept {
  Support support;
  if (depth <= 0.0) return support;
  support.depth = depth;
  // What stands in behind the last point weighs nothing.
  std::fill_n(depths + points.size(), kDepthsBehind, -std::numeric_limits<double>::infinity());
  const Weighed* const weighed = part.weighed.data();
  const __m256d greatest = _mm256_set1_pd(depth);
  const __m256d width = _mm256_set1_pd(std::min(kSupportBand, depth));
  __m256d place_radius = _mm256_setzero_pd();
  __m128d weight_width = _mm_setzero_pd();
  for (std::size_t k = 0; k < points.size(); k += 4) {
    const __m256d share = _mm256_sub_pd(
        _mm256_set1_pd(1.0), _mm256_div_pd(_mm256_sub_pd(greatest, _mm256_loadu_pd(depths + k)), width));
    if (_mm256_movemask_pd(_mm256_cmp_pd(share, _mm256_setzero_pd(), _CMP_GT_OQ)) == 0) continue;
    const FourPoints four = four_from(weighed, points.data() + k, points.size() - k);
    const __m256d area = _mm256_setr_pd(four[0]->area, four[1]->area, four[2]->area, four[3]->area);
    alignas(32) double weights[4];
    _mm256_store_pd(weights, _mm256_mul_pd(area, _mm256_max_pd(share, _mm256_setzero_pd())));
    for (std::size_t i = 0; i < 4; ++i) {
      const __m256d weight = _mm256_broadcast_sd(&weights[i]);
      place_radius = _mm256_add_pd(place_radius, _mm256_mul_pd(weight, _mm256_load_pd(&four[i]->x)));
      weight_width =
          _mm_add_pd(weight_width, _mm_mul_pd(_mm256_castpd256_pd128(weight), _mm_load_pd(&four[i]->one)));
    }
  }
  alignas(32) double sums[4];
  _mm256_store_pd(sums, place_radius);
  const double total = _mm_cvtsd_f64(weight_width);
  support.mean = Vec3(sums[0], sums[1], sums[2]) / total;
  support.tip_radius = sums[3] / total;
  support.half_width = _mm_cvtsd_f64(_mm_unpackhi_pd(weight_width, weight_width)) / total;
  return support;
}

}  // namespace
}  // namespace by_four

namespace {
const bool kFour = __builtin_cpu_supports("avx2") != 0;
}  // namespace

double full_depths(const PartPoints& part, const Vec3& point, const Vec3& normal,
                   std::span<const std::uint16_t> points, double* depths) noexcept {
  return kFour ? by_four::full_depths(part, point, normal, points, depths)
               : by_two::full_depths(part, point, normal, points, depths);
}

Support sum_up(const PartPoints& part, std::span<const std::uint16_t> points, double* depths,
               double depth) noexcept {
  return kFour ? by_four::sum_up(part, points, depths, depth) : by_two::sum_up(part, points, depths, depth);
}

}  // namespace palpate::contact
