#include "core/deform/block_inverse.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "core/base/parallel.h"
#include "core/base/simd.h"
#include "core/deform/inverse_panels.h"

namespace palpate::deform {
namespace {

using Eigen::Index;

constexpr std::size_t kGrain = 128;   // rows of a panel that one task computes
constexpr std::size_t kPastEnd = 1;   // entry: a node's three rows are read as four
constexpr std::size_t kTogether = 4;  // columns that are added in one pass

// The fastest for this processor.
const PanelKernel& kernel() noexcept {
#if defined(PALPATE_WITH_AVX2)
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0) return panel_kernel_avx2();
#endif
  return panel_kernel();
}

// Columns A such that a softened matrix has the inverse G + A A' (Woodbury's formula): F are the modes'
// forces, s their shares, and L L' = 1/s - F' G F, then A = G F L^-T. Empty when that matrix is not positive.
std::optional<Eigen::MatrixXf> added_columns(BlockMatrix& factor, const Softening& softening) {
  const auto modes = static_cast<Index>(softening.shares.size());
  const auto rows = static_cast<Index>(factor.first.back());
  if (modes == 0) return Eigen::MatrixXf(rows, 0);
  const Eigen::Map<const Eigen::MatrixXd> forces(softening.forces.data(), rows, modes);
  Eigen::MatrixXd motions = forces;
  kernel().solve(factor, motions.data(), softening.shares.size());
  const Eigen::Map<const Eigen::VectorXd> shares(softening.shares.data(), modes);
  const Eigen::LLT<Eigen::MatrixXd> root(Eigen::MatrixXd(shares.cwiseInverse().asDiagonal()) -
                                         forces.transpose() * motions);
  if (root.info() != Eigen::Success) return std::nullopt;
  return Eigen::MatrixXf(root.matrixL().solve(motions.transpose()).transpose().cast<float>());
}

}  // namespace

bool factorize(BlockMatrix& matrix) { return kernel().factorize(matrix); }

void solve(BlockMatrix& factor, std::vector<double>& columns) {
  kernel().solve(factor, columns.data(), columns.size() / factor.first.back());
}

std::optional<BlockInverse> BlockInverse::of(BlockMatrix matrix, const Softening& softening) {
  if (!factorize(matrix)) return std::nullopt;
  const std::optional<Eigen::MatrixXf> added = added_columns(matrix, softening);
  if (!added) return std::nullopt;
  BlockInverse made;
  made.first_ = matrix.first;
  const std::size_t size = made.start(matrix.blocks());
  made.entries_.resize(size + kPastEnd);
  made.scale_.resize(matrix.first.back());
  const Panels panels = {
      &made.entries_[size], made.scale_.data(), [](std::size_t count, Panels::Body body, const void* of) {
        for_ranges(count, kGrain, [body, of](std::size_t begin, std::size_t end) { body(of, begin, end); });
      }};
  if (!kernel().compute(matrix, added->data(), softening.shares.size(), panels)) return std::nullopt;
  return made;
}

std::optional<BlockInverse> BlockInverse::of(std::vector<std::size_t> first, std::vector<float> scale,
                                             std::vector<std::int16_t> entries) {
  BlockInverse made;
  made.first_ = std::move(first);
  made.scale_ = std::move(scale);
  made.entries_ = std::move(entries);
  if (made.rows() != made.first_.back() ||
      made.entries_.size() != made.start(made.first_.size() - 1) + kPastEnd)
    return std::nullopt;
  return made;
}

std::size_t BlockInverse::start(std::size_t block) const noexcept {
  std::size_t before = 0;
  for (std::size_t k = 0; k < block; ++k) before += (first_.back() - first_[k]) * (first_[k + 1] - first_[k]);
  return before;
}

BlockInverse::ByAxis BlockInverse::columns(Weights weights) const {
  ByAxis sums;
  sums.fill(std::vector<float>(rows(), 0.0F));
  for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
    const auto in_block = [&weights, first = first_[k + 1]] {
      return static_cast<std::size_t>(std::find_if(weights.begin(), weights.end(),
                                                   [first](const auto& weight) {
                                                     return 3 * static_cast<std::size_t>(weight.first) >=
                                                            first;
                                                   }) -
                                      weights.begin());
    }();
    add_columns(k, weights.first(in_block), sums);
    weights = weights.subspan(in_block);
    if (!weights.empty()) add_rows(k, weights, sums);
  }
  return sums;
}

void BlockInverse::add_columns(std::size_t block, Weights weights, ByAxis& sums) const {
  const std::size_t height = rows() - first_[block];
  const std::int16_t* const panel = &entries_[start(block)];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float* const to = &sums[axis][first_[block]];
    for (std::size_t w = 0; w < weights.size(); w += kTogether) {
      std::array<const std::int16_t*, kTogether> from{};
      std::array<Float4, kTogether> by{};
      for (std::size_t i = 0; i < kTogether; ++i) {
        const auto& [node, weight] = weights[std::min(w + i, weights.size() - 1)];
        const std::size_t column = 3 * static_cast<std::size_t>(node) + axis;
        from[i] = panel + (column - first_[block]) * height;
        by[i] = Float4(w + i < weights.size() ? weight * scale_[column] : 0.0F);
      }
      std::size_t row = 0;
      for (; row + Float4::kSize <= height; row += Float4::kSize) {
        const Float4 one =
            by[0] * Float4::converted(from[0] + row) + by[1] * Float4::converted(from[1] + row);
        const Float4 two =
            by[2] * Float4::converted(from[2] + row) + by[3] * Float4::converted(from[3] + row);
        (Float4::load_unaligned(to + row) + (one + two)).store_unaligned(to + row);
      }
      for (; row < height; ++row)
        for (std::size_t i = 0; i < kTogether; ++i)
          to[row] += by[i].get(0) * static_cast<float>(from[i][row]);
    }
  }
}

void BlockInverse::add_rows(std::size_t block, Weights weights, ByAxis& sums) const {
  const std::size_t height = rows() - first_[block];
  const std::int16_t* const panel = &entries_[start(block)];
  for (std::size_t column = first_[block]; column < first_[block + 1]; ++column) {
    const std::int16_t* const from = panel + (column - first_[block]) * height;
    const auto part = [&weights, from, first = first_[block]](std::size_t w) {
      const auto& [node, weight] = weights[w];
      return Float4(weight) * Float4::converted(from + (3 * static_cast<std::size_t>(node) - first));
    };
    std::array<Float4, 2> sum = {Float4(0.0F), Float4(0.0F)};  // axes in lanes
    std::size_t w = 0;
    for (; w + 2 <= weights.size(); w += 2) {
      sum[0] += part(w);
      sum[1] += part(w + 1);
    }
    if (w < weights.size()) sum[0] += part(w);
    for (std::size_t axis = 0; axis < 3; ++axis)
      sums[axis][column] += scale_[column] * (sum[0].get(axis) + sum[1].get(axis));
  }
}

}  // namespace palpate::deform
