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
// 3. A softened matrix (attachment_joints.h) has the inverse G + A A', with few columns A (block_inverse.cc).
// 4. A panel is kept in 16-bit integers: half a matrix of 3,000 rows has 9 MB.
//
// Eigen is vectorized in this file alone; elsewhere it is not, so that forces have the same bits on every
// processor. For x86-64 the file is compiled twice: for all processors, and for those that have AVX2. Names
// of Eigen are others in each, so that the linker does not take one for the other. For the same reason no
// other template may leave code in its object (CMakeLists.txt has the test), hence plain functions in Panels.
//
// Source of the recursion: Meurant 1992, A review on the inverse of symmetric tridiagonal and block
// tridiagonal matrices.

#include "core/deform/inverse_panels.h"

#include <algorithm>

#undef EIGEN_DONT_VECTORIZE
#if defined(PALPATE_AVX2)
#define Eigen PalpateAvx2Eigen  // NOLINT(readability-identifier-naming)
#define panel_kernel panel_kernel_avx2
#else
#define Eigen PalpateVectorizedEigen  // NOLINT(readability-identifier-naming)
#endif
#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Mapped = Eigen::Map<Eigen::MatrixXd>;

constexpr float kLargest = 32767.0F;
constexpr Index kColumns = 64;  // of a triangular inverse that are computed at once

Mapped mapped(std::vector<double>& matrix, std::size_t rows, std::size_t columns) {
  return {matrix.data(), static_cast<Index>(rows), static_cast<Index>(columns)};
}

struct Pivot {
  MatrixXf inverse;  // S_k^-1
  MatrixXf carries;  // X_k; empty for the last
};

// Replaces the matrix by Cholesky's factor. @return false when it is not positive
bool replace_by_factor(BlockMatrix& matrix) {
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

void replace_by_solution(BlockMatrix& factor, double* columns, std::size_t count) {
  Mapped all(columns, static_cast<Index>(factor.first.back()), static_cast<Index>(count));
  const auto part = [&](std::size_t k) {
    return all.middleRows(static_cast<Index>(factor.first[k]), static_cast<Index>(factor.size(k)));
  };
  const auto diagonal = [&](std::size_t k) {
    return mapped(factor.diagonal[k], factor.size(k), factor.size(k));
  };
  const auto coupling = [&](std::size_t k) {
    return mapped(factor.coupling[k], factor.size(k + 1), factor.size(k));
  };
  for (std::size_t k = 0; k < factor.blocks(); ++k) {
    auto here = part(k);
    if (k > 0) here.noalias() -= coupling(k - 1) * part(k - 1);
    diagonal(k).triangularView<Eigen::Lower>().solveInPlace(here);
  }
  for (std::size_t k = factor.blocks(); k-- > 0;) {
    auto here = part(k);
    if (k + 1 < factor.blocks()) here.noalias() -= coupling(k).transpose() * part(k + 1);
    diagonal(k).triangularView<Eigen::Lower>().transpose().solveInPlace(here);
  }
}

Pivot pivot_of(BlockMatrix& factor, std::size_t k) {
  const std::size_t size = factor.size(k);
  const Mapped diagonal = mapped(factor.diagonal[k], size, size);
  Eigen::MatrixXd below = Eigen::MatrixXd::Identity(diagonal.rows(), diagonal.cols());
  for (Index c = 0; c < diagonal.cols(); c += kColumns) {  // above them all is zero
    const Index rows = diagonal.rows() - c;
    auto columns = below.block(c, c, rows, std::min(kColumns, rows));
    diagonal.bottomRightCorner(rows, rows).triangularView<Eigen::Lower>().solveInPlace(columns);
  }
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
MatrixXf next_panel(const Pivot& pivot, const MatrixXf& below, const Panels& to) {
  const Index size = pivot.inverse.rows();
  MatrixXf panel(size + below.rows(), size);
  const auto rows = [&](std::size_t begin, std::size_t end) {
    const auto count = static_cast<Index>(end - begin);
    panel.middleRows(size + static_cast<Index>(begin), count).noalias() =
        -(below.middleRows(static_cast<Index>(begin), count) * pivot.carries);
  };
  to.in_ranges(
      static_cast<std::size_t>(below.rows()),
      [](const void* of, std::size_t begin, std::size_t end) {
        (*static_cast<const decltype(rows)*>(of))(begin, end);
      },
      &rows);
  panel.topRows(size) = pivot.inverse;
  panel.topRows(size).noalias() -= pivot.carries.transpose() * panel.middleRows(size, pivot.carries.rows());
  return panel;
}

// In 32,767ths of each column's largest entry.
void write(const MatrixXf& panel, std::int16_t* entries, float* scale) {
  for (Index c = 0; c < panel.cols(); ++c) {
    const float largest = panel.col(c).cwiseAbs().maxCoeff();
    const float steps = kLargest / largest;
    scale[c] = largest / kLargest;
    for (Index r = 0; r < panel.rows(); ++r) {
      const float rounded = panel(r, c) * steps + (panel(r, c) < 0.0F ? -0.5F : 0.5F);
      *entries++ = static_cast<std::int16_t>(static_cast<std::int32_t>(rounded));
    }
  }
}

bool compute(BlockMatrix& factor, const float* added, std::size_t count, const Panels& to) {
  const Eigen::Map<const MatrixXf> columns(added, static_cast<Index>(factor.first.back()),
                                           static_cast<Index>(count));
  MatrixXf panel;
  std::int16_t* end = to.end;
  for (std::size_t k = factor.blocks(); k-- > 0;) {
    const Pivot pivot = pivot_of(factor, k);
    panel = panel.size() == 0 ? pivot.inverse : next_panel(pivot, panel, to);
    if (!panel.allFinite()) return false;
    end -= panel.size();
    float* const scale = to.scale + factor.first[k];
    if (count == 0) {
      write(panel, end, scale);
    } else {
      const auto own = columns.middleRows(static_cast<Index>(factor.first[k]), panel.cols());
      write(panel + columns.bottomRows(panel.rows()) * own.transpose(), end, scale);
    }
  }
  return true;
}

}  // namespace

const PanelKernel& panel_kernel() noexcept {
  static constexpr PanelKernel kKernel{replace_by_factor, replace_by_solution, compute};
  return kKernel;
}

}  // namespace palpate::deform
