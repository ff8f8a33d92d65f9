// `mpirun palpate generate` gives the same bytes on any number of ranks.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/mpi_program.h"

namespace palpate::tests {
namespace {

TEST(GenerateMpi, EpisodesForLearningAreTheSameBytesOnOneTwoAndFourRanks) {
  const Folder folder;
  const std::string words =
      "generate --organ box --policy random --stiffness-factor 0.5:2 --episodes 5 --steps 50 --out e.h5";
  ASSERT_EQ(shell(folder, "'" + std::string(PALPATE_PROGRAM) + "' " + words), 0) << text_of(folder / "err");
  const std::string alone = text_of(folder / "e.h5");
  EXPECT_GT(alone.size(), 8U * 5U * 50U * 13U);
  for (const int ranks : {1, 2, 4}) {
    fs::remove(folder / "e.h5");
    ASSERT_EQ(shell(folder, by_mpi(ranks, words)), 0) << text_of(folder / "err");
    EXPECT_TRUE(text_of(folder / "e.h5") == alone) << ranks << " ranks";
  }
}

}  // namespace
}  // namespace palpate::tests
