#include "core/deform/block_inverse.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/base/parallel.h"

namespace palpate::deform {
namespace {

using Eigen::Index;

// Blocks of 5, 1, 8 and 3 nodes, random, positive because the diagonal outweighs each row.
constexpr std::array<std::size_t, 5> kFirst = {0, 15, 18, 42, 51};

Eigen::MatrixXd random_matrix() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(51, 51);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t column = kFirst[k]; column < kFirst[k + 1]; ++column) {
      for (std::size_t row = column; row < kFirst[std::min<std::size_t>(k + 2, 4)]; ++row) {
        const double value = number(random);
        matrix(static_cast<Index>(row), static_cast<Index>(column)) = value;
        matrix(static_cast<Index>(column), static_cast<Index>(row)) = value;
      }
    }
  }
  for (Index i = 0; i < 51; ++i) matrix(i, i) = 0.5 + matrix.row(i).cwiseAbs().sum();
  return matrix;
}

BlockMatrix in_blocks(const Eigen::MatrixXd& matrix) {
  BlockMatrix made;
  made.first.assign(kFirst.begin(), kFirst.end());
  const auto part = [&matrix](std::size_t row, std::size_t rows, std::size_t column, std::size_t columns) {
    const Eigen::MatrixXd block = matrix.block(static_cast<Index>(row), static_cast<Index>(column),
                                               static_cast<Index>(rows), static_cast<Index>(columns));
    return std::vector<double>(block.data(), block.data() + block.size());
  };
  for (std::size_t k = 0; k < 4; ++k) {
    made.diagonal.push_back(part(kFirst[k], made.size(k), kFirst[k], made.size(k)));
    if (k < 3) made.coupling.push_back(part(kFirst[k + 1], made.size(k + 1), kFirst[k], made.size(k)));
  }
  return made;
}

TEST(BlockInverse, IsThatOfASoftenedMatrix) {
  const Eigen::MatrixXd matrix = random_matrix();
  Softening softening{{}, {0.3, 0.7}};
  Eigen::MatrixXd softened = matrix;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-0.6, 0.6);
  for (const double share : softening.shares) {
    Eigen::VectorXd force(51);
    for (double& x : force) x = number(random);
    softened -= share * force * force.transpose();
    softening.forces.insert(softening.forces.end(), force.begin(), force.end());
  }
  const Eigen::MatrixXd inverse = softened.inverse();
  const double largest = inverse.cwiseAbs().maxCoeff();
  ASSERT_GT((inverse - matrix.inverse()).cwiseAbs().maxCoeff(), 0.05 * largest);
  const std::optional<BlockInverse> blocks = BlockInverse::of(in_blocks(matrix), softening);
  ASSERT_TRUE(blocks.has_value());
  for (std::int32_t node = 0; node < 17; ++node) {
    const std::array<std::pair<std::int32_t, float>, 1> weight = {{{node, 1.0F}}};
    const BlockInverse::ByAxis columns = blocks->columns(weight);
    for (Index axis = 0; axis < 3; ++axis)
      for (Index row = 0; row < 51; ++row)
        EXPECT_NEAR(
            static_cast<double>(columns[static_cast<std::size_t>(axis)][static_cast<std::size_t>(row)]),
            inverse(row, 3 * node + axis), 1e-4 * largest);
  }
}

TEST(BlockInverse, IsRefusedWhenSofteningLeavesAMatrixThatIsNotPositive) {
  const Eigen::MatrixXd matrix = random_matrix();
  Softening softening{std::vector<double>(51, 0.0), {1.1 * matrix(0, 0)}};
  softening.forces[0] = 1.0;
  EXPECT_FALSE(BlockInverse::of(in_blocks(matrix), softening).has_value());
}

TEST(BlockInverse, SumsColumnsOfTheInverseWithinAPartOfTheirLargestEntry) {
  const Eigen::MatrixXd matrix = random_matrix();
  const Eigen::MatrixXd inverse = matrix.inverse();
  const std::optional<BlockInverse> blocks = BlockInverse::of(in_blocks(matrix));
  ASSERT_TRUE(blocks.has_value());
  ASSERT_EQ(blocks->rows(), 51U);
  const std::vector<std::pair<std::int32_t, float>> weights = {
      {0, 0.25F}, {3, 1.0F}, {5, -2.0F}, {12, 0.5F}, {16, 0.75F}};
  const BlockInverse::ByAxis sums = blocks->columns(weights);
  for (Index axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(51);
    for (const auto& [node, weight] : weights) right[3 * node + axis] = static_cast<double>(weight);
    const Eigen::VectorXd expected = matrix.lu().solve(right);
    for (Index row = 0; row < 51; ++row) {
      // Half a step of 1/32,767 of the largest entry, by the sum of the weights; and single precision.
      EXPECT_NEAR(static_cast<double>(sums[static_cast<std::size_t>(axis)][static_cast<std::size_t>(row)]),
                  expected[row], 4.5 * inverse.cwiseAbs().maxCoeff() / 60000.0)
          << "row " << row << ", axis " << axis;
    }
  }
}

TEST(BlockInverse, HasTheSameBitsOnAnyNumberOfProcessors) {
  const auto sums = [] {
    return BlockInverse::of(in_blocks(random_matrix()))
        ->columns(std::vector<std::pair<std::int32_t, float>>{{9, 1.0F}});
  };
  const BlockInverse::ByAxis all = sums();
  const ThreadLimit one(1);
  EXPECT_EQ(all, sums());
}

TEST(BlockInverse, OfAMatrixThatIsNotPositiveIsEmpty) {
  Eigen::MatrixXd matrix = random_matrix();
  matrix(30, 30) = -1.0;
  EXPECT_FALSE(BlockInverse::of(in_blocks(matrix)).has_value());
}

}  // namespace
}  // namespace palpate::deform
