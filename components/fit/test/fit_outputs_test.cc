// Outputs of fits that equal inputs, or that cannot be written.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/refused_outputs.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr dev_t kFullDevice = (1 << 8) | 7;  // device number of /dev/full on Linux

/// Writes a curve that becomes stiffer.
void measure(const std::string& file) {
  std::ofstream out(file);
  out << "displacement_mm,force_N\n";
  for (int i = 0; i < 30; ++i) out << 0.2 * i << ',' << 0.05 * i + 0.001 * i * i << '\n';
}

TEST(FitOutputs, AFitOntoItsMeasurementsIsRefused) {
  const Folder folder;
  measure(folder / "a.csv");
  expect_refused_untouched(folder, {"fit", "a.csv", "--out", "a.csv"}, "a.csv", "--out a.csv",
                           "the measurements a.csv");
  expect_refused_untouched(folder,
                           {"validate", "a.csv", "--tissue", "liver", "--report", ".", "--out", "a.csv"},
                           "a.csv", "--out a.csv", "the measurements a.csv");
}

TEST(FitOutputs, AFitToADeviceKeepsNoLinesBesideIt) {
  const Folder folder;
  measure(folder / "a.csv");
  const std::string full = folder / "full.toml";
  if (mknod(full.c_str(), S_IFCHR | 0600, kFullDevice) != 0) return;  // only root can make one
  const Outcome outcome = run(folder, {"fit", "a.csv", "--out", "full.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--out full.toml: cannot be written: No space left on device"));
  EXPECT_THAT(folder.names(), UnorderedElementsAre("a.csv", "full.toml"));
}

TEST(FitOutputs, AFolderThatIsNotThereOrTakesNoFileIsRefusedByEveryFlag) {
  const Folder folder;
  measure(folder / "m.csv");
  expect_unusable_outputs_refused(
      folder, {{"fit", "m.csv", "--out"},
               {"fit", "m.csv", "--report"},
               {"validate", "m.csv", "--tissue", "liver", "--direction", "press", "--report"}});
}

}  // namespace
}  // namespace palpate::tests
