#pragma once
// What the triangles of a patch add to a point's averaged normal; for normals_by_clusters(), set-up only.
#include <array>
#include <cstddef>
#include <cstdint>

#include <xmmintrin.h>

#include "core/contact/averaged_normals.h"
#include "core/contact/normal_clusters.h"

namespace palpate::contact {

inline constexpr float kWithin = 0.99999F;  // of the radius: room for float's rounding

/// One point whose normal is wanted.
struct Target {
  Vec3 point;
  std::array<float, 3> reference;  // unit
  bool bends;                      // whether the slope is wanted
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  // of the sum with the point
};

inline std::array<float, 3> from_centre(const Patch& patch, const Vec3& point) noexcept {
  return {static_cast<float>(point.x() - static_cast<double>(patch.centre[0])),
          static_cast<float>(point.y() - static_cast<double>(patch.centre[1])),
          static_cast<float>(point.z() - static_cast<double>(patch.centre[2]))};
}

inline float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline float squared_distance(const std::array<float, 3>& a, const std::array<float, 3>& b) noexcept {
  const std::array<float, 3> apart{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return dot(apart, apart);
}

inline std::array<float, 3> rounded(const Vec3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

inline Vec3 exact(const std::array<float, 3>& v) noexcept { return {v[0], v[1], v[2]}; }

enum class Reach { kOut, kPartly, kWhole };

inline Reach reach_of(const Patch& patch, const std::array<float, 3>& u, float radius) noexcept {
  const float squared = dot(u, u);
  const float farthest = radius + patch.reach;
  if (squared >= farthest * farthest) return Reach::kOut;
  const float nearest = kWithin * radius - patch.reach;
  return nearest > 0.0F && squared <= nearest * nearest ? Reach::kWhole : Reach::kPartly;
}

enum class Turn { kAway, kPartly, kTowards };

inline Turn turn_of(const std::array<float, 3>& axis, float spread,
                    const std::array<float, 3>& reference) noexcept {
  const float cosine = dot(axis, reference);
  const float slack = spread + 1e-5F;
  if (cosine + slack <= static_cast<float>(kSharpCosine)) return Turn::kAway;
  return cosine - slack >= static_cast<float>(kFullCosine) ? Turn::kTowards : Turn::kPartly;
}

/// The sum over a patch all of which is in reach and turned towards the reference.
inline void add_whole(const Patch& patch, const std::array<float, 3>& u, float inverse_squared,
                      Target& target) noexcept {
  const float own = 3.0F - 3.0F * dot(u, u) * inverse_squared;
  for (std::size_t i = 0; i < 3; ++i) {
    const float moment =
        patch.sum_Am[3 * i] * u[0] + patch.sum_Am[3 * i + 1] * u[1] + patch.sum_Am[3 * i + 2] * u[2];
    const auto row = static_cast<Eigen::Index>(i);
    target.sum[row] +=
        static_cast<double>(own * patch.sum_A[i] + (2.0F * moment - patch.sum_Aq[i]) * inverse_squared);
    if (!target.bends) continue;
    for (std::size_t j = 0; j < 3; ++j) {
      target.slope(row, static_cast<Eigen::Index>(j)) += static_cast<double>(
          (2.0F * patch.sum_Am[3 * i + j] - 6.0F * patch.sum_A[i] * u[j]) * inverse_squared);
    }
  }
}

/// Four triangles of a block at a time.
struct Four {
  __m128 x, y, z;

  [[nodiscard]] __m128 dot(const Four& other) const noexcept {
    return _mm_add_ps(_mm_add_ps(_mm_mul_ps(x, other.x), _mm_mul_ps(y, other.y)), _mm_mul_ps(z, other.z));
  }
  [[nodiscard]] Four plus(const Four& other) const noexcept {
    return {_mm_add_ps(x, other.x), _mm_add_ps(y, other.y), _mm_add_ps(z, other.z)};
  }
  [[nodiscard]] Four times(__m128 factor) const noexcept {
    return {_mm_mul_ps(x, factor), _mm_mul_ps(y, factor), _mm_mul_ps(z, factor)};
  }
  [[nodiscard]] Four minus(const Four& other) const noexcept {
    return {_mm_sub_ps(x, other.x), _mm_sub_ps(y, other.y), _mm_sub_ps(z, other.z)};
  }
};

inline Four four_of(const std::array<float, 3>& v) noexcept {
  return {_mm_set1_ps(v[0]), _mm_set1_ps(v[1]), _mm_set1_ps(v[2])};
}

inline Four load(const Block::Row* rows, std::size_t from) noexcept {
  return {_mm_loadu_ps(&rows[0][from]), _mm_loadu_ps(&rows[1][from]), _mm_loadu_ps(&rows[2][from])};
}

inline double sum_of(__m128 four) noexcept {
  alignas(16) std::array<float, 4> lane;
  _mm_store_ps(lane.data(), four);
  return static_cast<double>((lane[0] + lane[1]) + (lane[2] + lane[3]));
}

/// Weights of four triangles and how they rise with the point's place, times half the radius squared.
struct Weights {
  __m128 weight;
  Four rise;
};

/// Weights of four triangles with short edges: the sum over the middles of the edges, which is zero or more
/// for all three together and not for each.
inline Weights weights(const Block& block, std::size_t from, const Four& u, __m128 inverse) noexcept {
  const Four apart = load(block.middle.data(), from).minus(u);
  const __m128 three = _mm_set1_ps(3.0F);
  const __m128 squares = _mm_add_ps(_mm_mul_ps(three, apart.dot(apart)), _mm_loadu_ps(&block.size[from]));
  const __m128 weight = _mm_max_ps(_mm_setzero_ps(), _mm_sub_ps(three, _mm_mul_ps(squares, inverse)));
  return {weight, apart.times(_mm_and_ps(three, _mm_cmpgt_ps(weight, _mm_setzero_ps())))};
}

/// Weights by the rule itself: of each edge's middle, and none for a triangle without a corner in reach.
inline Weights weights(const EdgeMiddles& edges, std::size_t from, const Four& u, __m128 inverse) noexcept {
  const __m128 one = _mm_set1_ps(1.0F);
  const std::array<Four, 3> middle{load(&edges.middle[0], from).minus(u),
                                   load(&edges.middle[3], from).minus(u),
                                   load(&edges.middle[6], from).minus(u)};
  const Four all{_mm_add_ps(_mm_add_ps(middle[0].x, middle[1].x), middle[2].x),
                 _mm_add_ps(_mm_add_ps(middle[0].y, middle[1].y), middle[2].y),
                 _mm_add_ps(_mm_add_ps(middle[0].z, middle[1].z), middle[2].z)};
  __m128 weight = _mm_setzero_ps();
  Four rise = four_of({0.0F, 0.0F, 0.0F});
  __m128 nearest = _mm_set1_ps(1e30F);
  for (const Four& m : middle) {
    const __m128 share = _mm_sub_ps(one, _mm_mul_ps(m.dot(m), inverse));
    const __m128 counts = _mm_cmpgt_ps(share, _mm_setzero_ps());
    weight = _mm_add_ps(weight, _mm_and_ps(counts, share));
    rise = rise.plus(m.times(_mm_and_ps(counts, one)));
    const Four corner = all.minus(m).minus(m);  // the one across from this edge
    nearest = _mm_min_ps(nearest, corner.dot(corner));
  }
  const __m128 in_reach = _mm_cmplt_ps(_mm_mul_ps(nearest, inverse), one);
  return {_mm_and_ps(weight, in_reach), rise.times(_mm_and_ps(in_reach, one))};
}

/// The sum over a block's triangles one by one, each with its own weight and turn. @param towards whether all
/// are turned towards the reference
template <bool kWithSlope>
void add_singly(const NormalClusters& clusters, const Block& block, const std::array<float, 3>& u,
                float radius, bool towards, Target& target) noexcept {
  const __m128 inverse = _mm_set1_ps(1.0F / (radius * radius));
  const __m128 sharp = _mm_set1_ps(static_cast<float>(kSharpCosine));
  const __m128 steepness = _mm_set1_ps(static_cast<float>(1.0 / (kFullCosine - kSharpCosine)));
  const Four to = four_of(u);
  const Four reference = four_of(target.reference);
  Four sum = four_of({0.0F, 0.0F, 0.0F});
  std::array<Four, 3> slope{sum, sum, sum};
  for (std::size_t from = 0; from < Block::kSize; from += 4) {
    const Weights found =
        block.edges < 0
            ? weights(block, from, to, inverse)
            : weights(clusters.edge_middles()[static_cast<std::size_t>(block.edges)], from, to, inverse);
    const Four normal = load(block.normal.data(), from);
    __m128 counts = _mm_loadu_ps(&block.area[from]);
    if (!towards) {
      const __m128 turn = _mm_mul_ps(_mm_sub_ps(normal.dot(reference), sharp), steepness);
      counts = _mm_mul_ps(counts, _mm_min_ps(_mm_set1_ps(1.0F), _mm_max_ps(_mm_setzero_ps(), turn)));
    }
    const Four area = normal.times(counts);
    sum = sum.plus(area.times(found.weight));
    if constexpr (kWithSlope) {
      slope = {slope[0].plus(found.rise.times(area.x)), slope[1].plus(found.rise.times(area.y)),
               slope[2].plus(found.rise.times(area.z))};
    }
  }
  target.sum += Vec3(sum_of(sum.x), sum_of(sum.y), sum_of(sum.z));
  if constexpr (!kWithSlope) return;
  const double steepest = 2.0 / (static_cast<double>(radius) * static_cast<double>(radius));
  for (int i = 0; i < 3; ++i) {
    const Four& row = slope[static_cast<std::size_t>(i)];
    target.slope.row(i) += steepest * Vec3(sum_of(row.x), sum_of(row.y), sum_of(row.z)).transpose();
  }
}

inline void add_singly(const NormalClusters& clusters, const Block& block, const std::array<float, 3>& u,
                       float radius, bool towards, Target& target) noexcept {
  if (target.bends) {
    add_singly<true>(clusters, block, u, radius, towards, target);
  } else {
    add_singly<false>(clusters, block, u, radius, towards, target);
  }
}

/// Adds what a cluster's triangles within reach of the target count.
inline void add_cluster(const NormalClusters& clusters, std::int32_t index, const std::array<float, 3>& u,
                        Reach reach, float radius, Target& target) noexcept {
  const NormalClusters::Cluster& cluster = clusters.cluster(static_cast<std::size_t>(index));
  const Turn turn = turn_of(cluster.patch.axis, cluster.patch.spread, target.reference);
  if (turn == Turn::kAway) return;
  const float inverse = 1.0F / (radius * radius);
  if (reach == Reach::kWhole && turn == Turn::kTowards) {
    add_whole(cluster.patch, u, inverse, target);
    return;
  }
  const std::size_t end =
      static_cast<std::size_t>(clusters.cluster(static_cast<std::size_t>(index) + 1).first_block);
  for (std::size_t i = static_cast<std::size_t>(cluster.first_block); i < end; ++i) {
    const Block& block = clusters.blocks()[i];
    const std::array<float, 3> v = from_centre(block.patch, target.point);
    const Reach block_reach = reach == Reach::kWhole ? reach : reach_of(block.patch, v, radius);
    if (block_reach == Reach::kOut) continue;
    const Turn block_turn =
        turn == Turn::kTowards ? turn : turn_of(block.patch.axis, block.patch.spread, target.reference);
    if (block_turn == Turn::kAway) continue;
    if (block_reach == Reach::kWhole && block_turn == Turn::kTowards) {
      add_whole(block.patch, v, inverse, target);
    } else {
      add_singly(clusters, block, v, radius, block_turn == Turn::kTowards, target);
    }
  }
}

/// Sums of patches all of which count in full, about one centre.
class SharedSum final {
 public:
  explicit SharedSum(const Vec3& centre) : centre_(centre) {}

  void add(const Patch& patch) noexcept {
    const Vec3 shift = exact(patch.centre) - centre_;
    const Vec3 sum_A = exact(patch.sum_A);
    for (int i = 0; i < 3; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const Vec3 moment =
          exact({patch.sum_Am[3 * row], patch.sum_Am[3 * row + 1], patch.sum_Am[3 * row + 2]});
      sum_Am_.row(i) += (moment + 3.0 * sum_A[i] * shift).transpose();
      sum_Aq_[i] += static_cast<double>(patch.sum_Aq[row]) + 2.0 * moment.dot(shift) +
                    3.0 * sum_A[i] * shift.squaredNorm();
    }
    sum_A_ += sum_A;
  }

  [[nodiscard]] Vec3 at(const Vec3& point, double radius) const noexcept {
    const Vec3 u = point - centre_;
    return sum_A_ * (3.0 - 3.0 * u.squaredNorm() / (radius * radius)) +
           (2.0 * (sum_Am_ * u) - sum_Aq_) / (radius * radius);
  }

  [[nodiscard]] Eigen::Matrix3d slope_at(const Vec3& point, double radius) const noexcept {
    const Vec3 u = point - centre_;
    return (2.0 * sum_Am_ - 6.0 * sum_A_ * u.transpose()) / (radius * radius);
  }

 private:
  Vec3 centre_;
  Vec3 sum_A_ = Vec3::Zero();
  Eigen::Matrix3d sum_Am_ = Eigen::Matrix3d::Zero();
  Vec3 sum_Aq_ = Vec3::Zero();
};

}  // namespace palpate::contact
