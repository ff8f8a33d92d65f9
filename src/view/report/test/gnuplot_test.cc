#include "view/report/gnuplot.h"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::report {
namespace {

using palpate::test::TemporaryFolder;
using ::testing::HasSubstr;

std::string read_script(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

constexpr const char* kScript =
    "set terminal svg\nset output 'figure.svg'\nset title 'a claim'\nplot 'points.dat' using 1:2\n";

TEST(Gnuplot, DrawsAFigureFromATable) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "drawn.svg";
  run_gnuplot(kScript, {{"points.dat", {{0.0, 1.0}, {1.0, 2.5}}}}, file);
  EXPECT_THAT(read_script(file), HasSubstr("<svg"));
  EXPECT_THAT(read_script(file), HasSubstr("a claim"));
}

TEST(Gnuplot, SaysWhichPackageIsMissing) {
  const TemporaryFolder folder;
  try {
    run_gnuplot(kScript, {{"points.dat", {{0.0, 1.0}}}}, folder.path() / "a.svg", "no-such-gnuplot");
    FAIL() << "nothing was thrown";
  } catch (const FigureError& error) {
    EXPECT_THAT(error.what(), HasSubstr("gnuplot-nox"));
  }
}

TEST(Gnuplot, PassesItsWordsOnWhenTheScriptIsWrong) {
  const TemporaryFolder folder;
  try {
    run_gnuplot("set nonsense\n", {}, folder.path() / "a.svg");
    FAIL() << "nothing was thrown";
  } catch (const FigureError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nonsense"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.svg"));
}

TEST(Gnuplot, RefusesAFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(run_gnuplot(kScript, {{"points.dat", {{0.0, 1.0}}}}, folder.path() / "none" / "a.svg"),
               InputError);
}

}  // namespace
}  // namespace palpate::report
