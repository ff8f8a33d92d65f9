#include "core/deform/inverse_panels.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace palpate::deform {
namespace {

using Eigen::Index;

// The columns of a triangular inverse are computed 64 at a time: blocks with fewer, just as many and more.
constexpr std::array<std::size_t, 5> kStart = {0, 150, 153, 217, 307};

struct PanelMatrix {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(307, 307);
  BlockMatrix blocks;
};

// Random, and positive because the diagonal outweighs each row.
PanelMatrix random_panels() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  PanelMatrix made;
  const auto part = [&made, &number, &random](std::size_t to, std::size_t from) {
    const auto row = static_cast<Index>(kStart[to]);
    const auto column = static_cast<Index>(kStart[from]);
    Eigen::MatrixXd values = Eigen::MatrixXd::NullaryExpr(static_cast<Index>(kStart[to + 1]) - row,
                                                          static_cast<Index>(kStart[from + 1]) - column,
                                                          [&number, &random] { return number(random); });
    if (to == from)
      values = ((values + values.transpose()) / 2.0 +
                400.0 * Eigen::MatrixXd::Identity(values.rows(), values.cols()))
                   .eval();
    made.whole.block(row, column, values.rows(), values.cols()) = values;
    made.whole.block(column, row, values.cols(), values.rows()) = values.transpose();
    return std::vector<double>(values.data(), values.data() + values.size());
  };
  made.blocks.first.assign(kStart.begin(), kStart.end());
  for (std::size_t k = 0; k < 4; ++k) {
    made.blocks.diagonal.push_back(part(k, k));
    if (k < 3) made.blocks.coupling.push_back(part(k + 1, k));
  }
  return made;
}

std::vector<PanelKernel> kernels_of_this_processor() {
  std::vector<PanelKernel> kernels = {panel_kernel()};
#if defined(PALPATE_WITH_AVX2)
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0)
    kernels.push_back(panel_kernel_avx2());
#endif
  return kernels;
}

TEST(InversePanels, HoldTheInverseFromTheDiagonalDownWithEachInstructionSet) {
  const PanelMatrix matrix = random_panels();
  const Eigen::MatrixXd inverse = matrix.whole.inverse();
  for (const PanelKernel& kernel : kernels_of_this_processor()) {
    BlockMatrix overwritten = matrix.blocks;
    std::vector<std::int16_t> entries(307 * 307);
    std::vector<float> scale(307);
    const Panels to = {&entries.back() + 1, scale.data(),
                       [](std::size_t count, Panels::Body body, const void* of) { body(of, 0, count); }};
    ASSERT_TRUE(kernel.factorize(overwritten));
    ASSERT_TRUE(kernel.compute(overwritten, nullptr, 0, to));
    const std::int16_t* entry = &entries.back() + 1;
    for (std::size_t k = 4; k-- > 0;) {
      entry -= (kStart[k + 1] - kStart[k]) * (kStart[4] - kStart[k]);
      const std::int16_t* at = entry;
      for (std::size_t column = kStart[k]; column < kStart[k + 1]; ++column) {
        const auto c = static_cast<Index>(column);
        const double largest = inverse.col(c).tail(307 - static_cast<Index>(kStart[k])).cwiseAbs().maxCoeff();
        for (std::size_t row = kStart[k]; row < kStart[4]; ++row, ++at)
          ASSERT_NEAR(static_cast<double>(*at) * static_cast<double>(scale[column]),
                      inverse(static_cast<Index>(row), c), largest / 60000.0)
              << "row " << row << ", column " << column;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::deform
