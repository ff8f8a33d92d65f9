// `mpirun palpate study power` gives the same bytes on any number of ranks.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mpi_program.h"

namespace palpate::tests {
namespace {

TEST(StudyMpi, PowerOfAStudyIsTheSameOnOneTwoAndFourRanks) {
  const Folder folder;
  std::ofstream(folder / "s.toml")
      << "[study]\nname = \"small\"\nscene = \"box\"\n[[condition]]\nname = \"off\"\nshare = 0.0\n"
         "[[condition]]\nname = \"on\"\nshare = 0.6\n"
         "[[task]]\nname = \"threshold\"\nkind = \"noise-threshold\"\n"
         "sigma_mN = { from = 1.0, to = 100.0, per_decade = 20 }\ntrials = 4\nsets_share_of = \"threshold\"\n"
         "[[task]]\nname = \"stiffness\"\nkind = \"stiffness\"\ndepth_mm = 8.0\n"
         "ratio = { least = 1.02, largest = 3.3, steps = 14 }\nconditions = [\"off\", \"on\"]\ntrials = 12\n"
         "[analysis]\nprimary = { task = \"stiffness\", contrast = \"on - off\", measure = \"ln_jnd\" }\n";
  const std::string words = "study power s.toml --participants 3,5 --groups 6 --json";
  ASSERT_EQ(shell(folder, "'" + std::string(PALPATE_PROGRAM) + "' " + words), 0) << text_of(folder / "err");
  const std::string alone = text_of(folder / "out");
  EXPECT_THAT(alone, testing::HasSubstr("\"power\""));
  for (const int ranks : {1, 2, 4}) {
    ASSERT_EQ(shell(folder, by_mpi(ranks, words)), 0) << text_of(folder / "err");
    EXPECT_EQ(text_of(folder / "out"), alone) << ranks << " ranks";
  }
}

}  // namespace
}  // namespace palpate::tests
