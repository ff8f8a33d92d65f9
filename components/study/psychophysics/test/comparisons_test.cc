#include "study/psychophysics/comparisons.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::psychophysics {
namespace {

TEST(Comparisons, PairedTestHasItsReferenceValues) {
  // Differences 1, 2, 3, 4, 5: mean 3, standard error sqrt(2.5/5), t(4, 0.975) = 2.776445.
  const PairedTest test = paired_t(std::vector<double>{1, 2, 3, 4, 5});
  EXPECT_EQ(test.mean, 3.0);
  EXPECT_NEAR(test.t, 4.242641, 1e-6);
  EXPECT_NEAR(test.low, 3.0 - 2.776445 * std::sqrt(0.5), 1e-5);
  EXPECT_NEAR(test.two_sided, 0.0132356, 1e-7);
  EXPECT_NEAR(test.greater, 0.5 * test.two_sided, 1e-15);
  EXPECT_NEAR(paired_t(std::vector<double>{-1, -2, -3, -4, -5}).greater, 1.0 - test.greater, 1e-12);
}

TEST(Comparisons, EqualDifferencesAreTested) {
  EXPECT_EQ(paired_t(std::vector<double>{2, 2}).greater, 0.0);
  EXPECT_EQ(paired_t(std::vector<double>{0, 0}).two_sided, 1.0);
  EXPECT_THROW((void)paired_t(std::vector<double>{1}), ParameterError);
}

TEST(Comparisons, HolmAdjustsInTheOrderOfThePValues) {
  // 0.01 x 4, 0.02 x 3, 0.03 x 2, and 0.04, which may not be below its predecessor.
  const std::vector<double> adjusted = holm(std::vector<double>{0.04, 0.01, 0.03, 0.02});
  EXPECT_NEAR(adjusted[1], 0.04, 1e-15);
  EXPECT_NEAR(adjusted[3], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[2], 0.06, 1e-15);
  EXPECT_NEAR(adjusted[0], 0.06, 1e-15);
  EXPECT_EQ(holm(std::vector<double>{0.6, 0.7}), (std::vector<double>{1.0, 1.0}));
}

// d' of three people at four levels, with small differences between them.
std::vector<std::vector<double>> people_with(double first, double middle, double last) {
  std::vector<std::vector<double>> people;
  for (const double own : {-0.02, 0.0, 0.02}) {
    people.push_back({first + own, middle - own, middle + 2.0 * own, last});
  }
  return people;
}

TEST(Comparisons, InvertedUNeedsRiseAndFall) {
  const std::vector<std::size_t> middle = {1, 2};
  EXPECT_TRUE(inverted_u(people_with(0.5, 1.0, 0.5), middle).found());
  EXPECT_FALSE(inverted_u(people_with(1.0, 1.0, 0.5), middle).found());
  EXPECT_FALSE(inverted_u(people_with(0.5, 1.0, 1.0), middle).found());
  EXPECT_FALSE(inverted_u(people_with(1.0, 0.5, 1.0), middle).found());
  EXPECT_NEAR(inverted_u(people_with(0.5, 1.0, 0.7), middle).rise.mean, 0.5, 1e-12);
  EXPECT_NEAR(inverted_u(people_with(0.5, 1.0, 0.7), middle).fall.mean, 0.3, 1e-12);
}

TEST(Comparisons, InvalidLevelsAreRejected) {
  const auto people = people_with(0.5, 1.0, 0.5);
  EXPECT_THROW((void)inverted_u(people, std::vector<std::size_t>{0}), ParameterError);
  EXPECT_THROW((void)inverted_u(people, std::vector<std::size_t>{3}), ParameterError);
  EXPECT_THROW((void)inverted_u(people, std::vector<std::size_t>{}), ParameterError);
  auto uneven = people;
  uneven[1].pop_back();
  EXPECT_THROW((void)inverted_u(uneven, std::vector<std::size_t>{1}), ParameterError);
}

TEST(Comparisons, WilliamsSquaresAreBalanced) {
  for (int n = 2; n <= 9; ++n) {
    const auto rows = williams_square(n);
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(n % 2 == 0 ? n : 2 * n));
    std::map<std::pair<int, int>, int> at_position;
    std::map<std::pair<int, int>, int> after;
    for (const std::vector<int>& row : rows) {
      ASSERT_EQ(row.size(), static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i) {
        ++at_position[{row[static_cast<std::size_t>(i)], i}];
        if (i > 0) ++after[{row[static_cast<std::size_t>(i - 1)], row[static_cast<std::size_t>(i)]}];
      }
    }
    const int each = n % 2 == 0 ? 1 : 2;
    EXPECT_EQ(at_position.size(), static_cast<std::size_t>(n * n));
    for (const auto& [key, count] : at_position) EXPECT_EQ(count, each);
    EXPECT_EQ(after.size(), static_cast<std::size_t>(n * (n - 1)));
    for (const auto& [key, count] : after) EXPECT_EQ(count, each);
  }
  EXPECT_THROW((void)williams_square(0), ParameterError);
}

}  // namespace
}  // namespace palpate::psychophysics
