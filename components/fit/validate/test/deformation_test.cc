#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/test/rejected_file.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/validate.h"

namespace palpate::validate {
namespace {

using palpate::test::TemporaryFolder;
using testing::HasSubstr;

const std::string kRows = "0,2\n1,1.5\n2,1\n5,0.4\n10,0.1\n";

std::vector<Deformation> read_deformation_text(const std::string& content) {
  const TemporaryFolder folder;
  return read_deformations(folder.write("side.csv", content));
}

std::string deformation_error_in(const std::string& content) {
  return palpate::test::rejection_of("side.csv", content,
                                     [](const auto& file) { (void)read_deformations(file); });
}

TEST(ReadDeformations, TakesMillimetresAndTheFilesName) {
  const std::vector<Deformation> all = read_deformation_text("r_mm,u_mm\n" + kRows);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].name, "side");
  EXPECT_EQ(all[0].depth, 0.0);
  ASSERT_EQ(all[0].size(), 5U);
  EXPECT_DOUBLE_EQ(all[0].distance[3], 5e-3);
  EXPECT_DOUBLE_EQ(all[0].displacement[3], 0.4e-3);
}

TEST(ReadDeformations, CountsTheOtherSideOfTheContactAndSortsByDistance) {
  const std::vector<Deformation> all = read_deformation_text("u_mm, r_mm\n1,2\n2,0\n1.1,-2\n0.5,-4\n0.4,4\n");
  const std::vector<double> distance = {0.0, 2e-3, 2e-3, 4e-3, 4e-3};
  EXPECT_EQ(all[0].distance, distance);
  EXPECT_DOUBLE_EQ(all[0].displacement[2], 1.1e-3);
}

TEST(ReadDeformations, TellsDepthsApart) {
  std::string text = "depth_mm,r_mm,u_mm\n";
  for (int i = 0; i < 5; ++i) {
    for (const int depth : {1, 3}) {
      text += std::to_string(depth) + "," + std::to_string(i) + "," + std::to_string(depth * (5 - i)) + "\n";
    }
  }
  const std::vector<Deformation> all = read_deformation_text(text);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].name, "side at 3 mm");
  EXPECT_DOUBLE_EQ(all[1].depth, 3e-3);
  EXPECT_DOUBLE_EQ(all[1].displacement[0], 15e-3);
}

TEST(ReadDeformations, RefusesABadRowNamingItsLine) {
  const std::string header = "r_mm,u_mm\n";
  EXPECT_THAT(deformation_error_in(header + "0,nan\n"),
              HasSubstr("side.csv:2: u_mm = nan: must be a finite number up to 1e6"));
  EXPECT_THAT(deformation_error_in("r_mm\n"), HasSubstr("u_mm: missing"));
  EXPECT_THAT(deformation_error_in("depth_mm,r_mm,u_mm\n0,1,1\n"), HasSubstr("depth_mm = 0: must be > 0"));
}

TEST(ReadDeformations, RefusesWhatNoProfileCanBeComparedWith) {
  const std::string header = "r_mm,u_mm\n";
  EXPECT_THAT(deformation_error_in(header + "0,1\n"), HasSubstr("has 1 row, must have at least 5"));
  EXPECT_THAT(deformation_error_in(header + "1,5\n1,4\n1,3\n1,2\n-1,1\n"),
              HasSubstr("r_mm is 1 in every row"));
  EXPECT_THAT(deformation_error_in(header + "0,1\n1,1\n2,1\n3,1\n4,1\n"),
              HasSubstr("u_mm is 1 in every row"));
  EXPECT_THAT(deformation_error_in(header + "0,-2\n1,-1.5\n2,-1\n3,-0.5\n4,0\n"),
              HasSubstr("does not decrease"));
  EXPECT_THAT(deformation_error_in(header + "0,-1\n1,-1.5\n2,-2\n3,-2.5\n4,-3\n"),
              HasSubstr("does not decrease"));
}

// Seven points reduced to three: means of the first two, the next two and the last three.
TEST(ThinnedDeformation, HasTheMeansOfNeighboursComputedByHand) {
  Deformation seven;
  seven.distance = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  seven.displacement = {7.0, 5.0, 4.0, 2.0, 1.5, 0.9, 0.6};
  const Deformation three = thinned(seven, 3);
  EXPECT_THAT(three.distance, testing::ElementsAre(0.5, 2.5, 5.0));
  EXPECT_THAT(three.displacement, testing::ElementsAre(6.0, 3.0, testing::DoubleEq(1.0)));
  EXPECT_EQ(thinned(seven, 7).distance, seven.distance);
}

// The result does not depend on the order of the rows and the side of the contact.
TEST(ReadDeformations, DoesNotDependOnTheOrderOfRows) {
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    std::vector<std::string> lines;
    for (int i = 0; i < 20; ++i) {
      const bool other_side = (trial + static_cast<std::uint32_t>(i)) % 3 == 0;
      lines.push_back((other_side ? "-" : "") + std::to_string(i) + "," + std::to_string(20 - i) + "\n");
    }
    std::string rising = "r_mm,u_mm\n";
    for (const std::string& line : lines) rising += line;
    std::string turned = "r_mm,u_mm\n";  // every k-th row, where k and 20 are coprime
    const std::size_t step = trial % 2 == 0 ? 7 : 11;
    for (std::size_t i = 0; i < lines.size(); ++i) turned += lines[(i * step + trial) % lines.size()];
    const Deformation first = read_deformation_text(rising)[0];
    const Deformation second = read_deformation_text(turned)[0];
    EXPECT_EQ(first.distance, second.distance) << trial;
    EXPECT_EQ(first.displacement, second.displacement) << trial;
  }
}

}  // namespace
}  // namespace palpate::validate
