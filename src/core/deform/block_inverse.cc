// The inverse of a stiffness matrix: displacements of all nodes under a unit force on any of them.
//
//        D_0 B_0'                   D_k: diagonal block, B_k couples block k+1 with block k
//        B_0 D_1 B_1'
//            B_1 D_2 ...
//
// 1. Downwards, the pivots S_0 = D_0, S_k+1 = D_k+1 - B_k S_k^-1 B_k', by Cholesky's factors in double
//    precision: an organ that can swing is a thousand times softer than its tissue.
// 2. Upwards, panel k of the inverse G (its columns of block k, from the diagonal down) from panel k+1:
//
//        X_k = B_k S_k^-1
//        G_jk = -G_j,k+1 X_k          j > k
//        G_kk = S_k^-1 - X_k' G_k+1,k
//
//    All terms of a diagonal entry are positive, so single precision serves. These products are nine tenths
//    of the work; rows are shared among the processors.
// 3. A panel is kept in 16-bit integers: half a matrix of 3,000 rows has 9 MB.
//
// Eigen is vectorized in this file alone; elsewhere it is not, so that forces have the same bits on every
// processor. Its names are others here, so that the linker does not take one for the other.
//
// Source of the recursion: Meurant 1992, A review on the inverse of symmetric tridiagonal and block
// tridiagonal matrices.

#include "core/deform/block_inverse.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/base/simd.h"

#undef EIGEN_DONT_VECTORIZE
#define Eigen PalpateVectorizedEigen  // NOLINT(readability-identifier-naming)
#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Mapped = Eigen::Map<Eigen::MatrixXd>;

constexpr std::size_t kGrain = 128;  // rows of a panel that one task computes
constexpr float kLargest = 32767.0F;
constexpr std::size_t kPastEnd = 1;   // entry: a node's three rows are read as four
constexpr std::size_t kTogether = 4;  // columns that are added in one pass

Mapped mapped(std::vector<double>& matrix, std::size_t rows, std::size_t columns) {
  return {matrix.data(), static_cast<Index>(rows), static_cast<Index>(columns)};
}

struct Pivot {
  MatrixXf inverse;  // S_k^-1
  MatrixXf carries;  // X_k; empty for the last
};

// Replaces the matrix by Cholesky's factor. @return false when it is not positive
bool factorize(BlockMatrix& matrix) {
  for (std::size_t k = 0; k < matrix.blocks(); ++k) {
    const std::size_t size = matrix.size(k);
    Mapped diagonal = mapped(matrix.diagonal[k], size, size);
    if (k > 0)
      diagonal.selfadjointView<Eigen::Lower>().rankUpdate(
          mapped(matrix.coupling[k - 1], size, matrix.size(k - 1)), -1.0);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(diagonal);
    if (factor.info() != Eigen::Success) return false;
    if (k + 1 < matrix.blocks()) {
      Mapped coupling = mapped(matrix.coupling[k], matrix.size(k + 1), size);
      diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(coupling);
    }
  }
  return true;
}

Pivot pivot_of(BlockMatrix& factor, std::size_t k) {
  const std::size_t size = factor.size(k);
  Eigen::MatrixXd below = Eigen::MatrixXd::Identity(static_cast<Index>(size), static_cast<Index>(size));
  mapped(factor.diagonal[k], size, size).triangularView<Eigen::Lower>().solveInPlace(below);
  const MatrixXf inverse = below.cast<float>();  // of the factor
  Pivot pivot;
  pivot.inverse.setZero(inverse.rows(), inverse.cols());
  pivot.inverse.selfadjointView<Eigen::Lower>().rankUpdate(inverse.transpose());
  pivot.inverse.triangularView<Eigen::StrictlyUpper>() = pivot.inverse.transpose();
  if (k + 1 < factor.blocks()) {
    const MatrixXf coupling = mapped(factor.coupling[k], factor.size(k + 1), size).cast<float>();
    pivot.carries = coupling * inverse.triangularView<Eigen::Lower>();
  }
  return pivot;
}

// Panel k of the inverse from panel k+1.
MatrixXf next_panel(const Pivot& pivot, const MatrixXf& below) {
  const Index size = pivot.inverse.rows();
  MatrixXf panel(size + below.rows(), size);
  for_ranges(static_cast<std::size_t>(below.rows()), kGrain, [&](std::size_t begin, std::size_t end) {
    const auto count = static_cast<Index>(end - begin);
    panel.middleRows(size + static_cast<Index>(begin), count).noalias() =
        -(below.middleRows(static_cast<Index>(begin), count) * pivot.carries);
  });
  panel.topRows(size) = pivot.inverse;
  panel.topRows(size).noalias() -= pivot.carries.transpose() * panel.middleRows(size, pivot.carries.rows());
  return panel;
}

}  // namespace

std::optional<BlockInverse> BlockInverse::of(BlockMatrix matrix) {
  if (!factorize(matrix)) return std::nullopt;
  BlockInverse made;
  made.first_ = matrix.first;
  made.entries_.resize(made.start(matrix.blocks()) + kPastEnd);
  made.scale_.resize(matrix.first.back());
  MatrixXf panel;
  for (std::size_t k = matrix.blocks(); k-- > 0;) {
    const Pivot pivot = pivot_of(matrix, k);
    panel = panel.size() == 0 ? pivot.inverse : next_panel(pivot, panel);
    if (!panel.allFinite()) return std::nullopt;
    std::int16_t* to = &made.entries_[made.start(k)];
    for (Index c = 0; c < panel.cols(); ++c) {
      const float largest = panel.col(c).cwiseAbs().maxCoeff();
      made.scale_[matrix.first[k] + static_cast<std::size_t>(c)] = largest / kLargest;
      for (Index r = 0; r < panel.rows(); ++r)
        *to++ = static_cast<std::int16_t>(std::lround(panel(r, c) * (kLargest / largest)));
    }
  }
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
