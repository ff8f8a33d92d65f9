#include "view/render/depth_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/simd.h"

namespace palpate::render {
namespace {

using Eigen::Vector3f;

constexpr float kSliver = 1e-6F;   // cells^2: a triangle seen edge-on; its neighbours cover the same cells
constexpr float kOverlap = 1e-4F;  // of a triangle: triangles overlap, so that rounding leaves no gaps
const float kDiagonal = std::sqrt(2.0F);
const float kKnight = std::sqrt(5.0F);

Float4 load(const float* from) { return Float4::load_unaligned(from); }

// Shifts the four values up by one or two; the lowest is repeated.
Float4 one_up(const Float4& a) { return Float4(Float4::Value{a.v[0], a.v[0], a.v[1], a.v[2]}); }
Float4 two_up(const Float4& a) { return Float4(Float4::Value{a.v[0], a.v[0], a.v[0], a.v[1]}); }
Float4 one_down(const Float4& a) { return Float4(Float4::Value{a.v[1], a.v[2], a.v[3], a.v[3]}); }
Float4 two_down(const Float4& a) { return Float4(Float4::Value{a.v[2], a.v[3], a.v[3], a.v[3]}); }
Float4 lowest(const Float4& a) { return Float4(Float4::Value{a.v[0], a.v[0], a.v[0], a.v[0]}); }
Float4 highest(const Float4& a) { return Float4(Float4::Value{a.v[3], a.v[3], a.v[3], a.v[3]}); }

}  // namespace

DepthMap::DepthMap() : cells_(static_cast<std::size_t>((kSide + 2 * kRowMargin + 1) * kStride), kNothing) {}

void DepthMap::add_triangle(const Vector3f& a, const Vector3f& b, const Vector3f& c, float most) {
  const Vector3f low = a.cwiseMin(b).cwiseMin(c);
  const Vector3f high = a.cwiseMax(b).cwiseMax(c);
  const auto last = static_cast<float>(kSide - 1);
  if (high.x() < 0.0F || low.x() > last || high.y() < 0.0F || low.y() > last) return;
  const Vector3f ab = b - a;
  const Vector3f ac = c - a;
  const float area = ab.x() * ac.y() - ac.x() * ab.y();
  if (std::abs(area) < kSliver) return;
  const int first_i = static_cast<int>(std::ceil(std::max(low.x(), 0.0F)));
  const int last_i = static_cast<int>(std::min(high.x(), last));
  const int first_j = static_cast<int>(std::max(low.y(), 0.0F)) / 4 * 4;
  const int last_j = static_cast<int>(std::min(high.y(), last));
  // The barycentric weights of b and c are linear in the column.
  const Float4 to_b(-ac.x() / area);
  const Float4 to_c(ab.x() / area);
  const Float4 least(-kOverlap);
  const Float4 columns({0.0F, 1.0F, 2.0F, 3.0F});
  for (int i = first_i; i <= last_i; ++i) {
    const float x = static_cast<float>(i) - a.x();
    const Float4 from_b(x * ac.y() / area);
    const Float4 from_c(-x * ab.y() / area);
    for (int j = first_j; j <= last_j; j += static_cast<int>(kLanes)) {
      const Float4 y = Float4(static_cast<float>(j) - a.y()) + columns;
      const Float4 share_b = from_b + y * to_b;
      const Float4 share_c = from_c + y * to_c;
      const Float4Mask covered =
          (share_b >= least) & (share_c >= least) & (share_b + share_c <= Float4(1.0F + kOverlap));
      float* const cell = &cells_[index(i, j)];
      const Float4 depth = Float4(a.z()) + share_b * Float4(ab.z()) + share_c * Float4(ac.z());
      const Float4 deepest = max(load(cell), min(depth, Float4(most)));
      select(covered, deepest, load(cell)).store_unaligned(cell);
    }
  }
}

void DepthMap::clear_margins(int i) noexcept {
  float* const row = &cells_[index(i, 0)];
  std::fill(row - kLeft, row, kNothing);
  std::fill(row + kSide, row + kStride - kLeft, kNothing);
}

// Applies the slope from the two neighbouring rows on the side given by `step`.
void DepthMap::slopes_from_rows(int i, int step, float rise) noexcept {
  const float* const near = &cells_[index(i + step, -kLeft)];
  const float* const far = &cells_[index(i + 2 * step, -kLeft)];
  float* const row = &cells_[index(i, -kLeft)];
  const Float4 straight(rise);
  const Float4 diagonal(kDiagonal * rise);
  const Float4 knight(kKnight * rise);
  for (int j = 0; j < kStride; j += static_cast<int>(kLanes)) {
    const Float4 beside = max(load(near + j - 1), load(near + j + 1)) - diagonal;
    const Float4 leaps =
        max(max(load(near + j - 2), load(near + j + 2)), max(load(far + j - 1), load(far + j + 1))) - knight;
    const Float4 best = max(max(load(near + j) - straight, beside), leaps);
    max(load(row + j), best).store_unaligned(row + j);
  }
}

// Applies the slope along a row, from each cell to the next.
void DepthMap::slopes_along(int i, bool forwards, float rise) noexcept {
  float* const row = &cells_[index(i, -kLeft)];
  const Float4 one(rise);
  const Float4 two(2.0F * rise);
  Float4 before(kNothing);
  if (forwards) {
    const Float4 ways = one * Float4({1.0F, 2.0F, 3.0F, 4.0F});
    for (int j = 0; j < kStride; j += static_cast<int>(kLanes)) {
      Float4 cells = load(row + j);
      cells = max(cells, one_up(cells) - one);
      cells = max(cells, two_up(cells) - two);
      cells = max(cells, before - ways);
      cells.store_unaligned(row + j);
      before = highest(cells);
    }
  } else {
    const Float4 ways = one * Float4({4.0F, 3.0F, 2.0F, 1.0F});
    for (int j = kStride - static_cast<int>(kLanes); j >= 0; j -= static_cast<int>(kLanes)) {
      Float4 cells = load(row + j);
      cells = max(cells, one_down(cells) - one);
      cells = max(cells, two_down(cells) - two);
      cells = max(cells, before - ways);
      cells.store_unaligned(row + j);
      before = lowest(cells);
    }
  }
}

void DepthMap::add_slopes(float rise) {
  for (int i = 0; i < kSide; ++i) {
    slopes_from_rows(i, -1, rise);
    slopes_along(i, true, rise);
    clear_margins(i);
  }
  for (int i = kSide - 1; i >= 0; --i) {
    slopes_from_rows(i, 1, rise);
    slopes_along(i, false, rise);
    clear_margins(i);
  }
}

void DepthMap::smooth(int rounds) {
  // Separable: along the rows, then the columns. Cells beyond the map repeat the edge.
  const Float4 third(1.0F / 3.0F);
  constexpr std::size_t kGroups = kStride / kLanes;
  std::array<float, kStride + 2> line{};
  for (int i = 0; i < kSide; ++i) {
    float* const row = &cells_[index(i, -kLeft)];
    std::fill(row, row + kLeft, row[kLeft]);
    std::fill(row + kLeft + kSide, row + kStride, row[kLeft + kSide - 1]);
    for (int round = 0; round < rounds; ++round) {
      std::copy_n(row, kStride, line.begin() + 1);
      line.front() = line[1];
      line.back() = line[kStride];
      for (std::size_t g = 0; g < kGroups; ++g) {
        const float* const from = &line[g * kLanes];
        ((load(from) + load(from + 1) + load(from + 2)) * third).store_unaligned(row + g * kLanes);
      }
    }
  }
  for (std::size_t g = 0; g < kGroups; ++g) {
    std::array<Float4, kSide + 2> column;
    float* const top = &cells_[index(0, -kLeft) + g * kLanes];
    for (std::size_t i = 0; i < kSide; ++i) column[i + 1] = load(top + i * kStride);
    for (int round = 0; round < rounds; ++round) {
      column.front() = column[1];
      column.back() = column[kSide];
      Float4 before = column.front();
      for (std::size_t i = 1; i <= kSide; ++i) {
        const Float4 here = column[i];
        column[i] = (before + here + column[i + 1]) * third;
        before = here;
      }
    }
    for (std::size_t i = 0; i < kSide; ++i) column[i + 1].store_unaligned(top + i * kStride);
  }
}

}  // namespace palpate::render
