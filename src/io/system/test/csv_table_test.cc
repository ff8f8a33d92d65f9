#include "io/system/csv_table.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/test/rejected_file.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

using palpate::test::TemporaryFolder;
using testing::HasSubstr;

enum Column : std::size_t { kTime, kDepth, kName };

const std::vector<CsvColumn> kColumns = {{"time_s", false}, {"depth_mm"}, {"specimen", false, true}};
const std::string kHeader = "time_s,depth_mm\n";

std::string error_in(const std::string& content) {
  return palpate::test::rejection_of("a.csv", content, [](const auto& file) {
    for (CsvTable table(file, kColumns, 1e9); table.next_row();) continue;
  });
}

std::vector<double> depths_in(const std::string& content) {
  const TemporaryFolder folder;
  std::vector<double> depths;
  for (CsvTable table(folder.write("a.csv", content), kColumns); table.next_row();) {
    depths.push_back(table.number(kDepth));
  }
  return depths;
}

TEST(CsvTable, FindsColumnsByNameInAnyOrder) {
  const TemporaryFolder folder;
  CsvTable table(folder.write("a.csv", "specimen,depth_mm\nleft , +0.5\n"), kColumns);
  EXPECT_FALSE(table.has(kTime));
  ASSERT_TRUE(table.next_row());
  EXPECT_EQ(table.number(kDepth), 0.5);
  EXPECT_EQ(table.number(kTime), 0.0);
  EXPECT_EQ(table.text(kName), "left");
  EXPECT_FALSE(table.next_row());
}

TEST(CsvTable, PassesOverCommentsBlankLinesByteOrderMarkAndCarriageReturns) {
  const std::vector<double> wanted = {1.0, 2.0};
  EXPECT_EQ(depths_in("\xEF\xBB\xBF# made by hand\r\n\r\n depth_mm \r\n1\r\n\n# middle\n2"), wanted);
}

TEST(CsvTable, RefusesHeadersThatAreMissingUnknownIncompleteOrTwice) {
  EXPECT_EQ(error_in("1,2\n"), "a.csv:1: the header is missing: the first line must name depth_mm");
  EXPECT_EQ(error_in("time_s,depthmm\n"), "a.csv:1: column \"depthmm\": unknown, did you mean depth_mm?");
  EXPECT_THAT(error_in("depth_mm,wholly\n"), HasSubstr("valid are time_s, depth_mm and specimen"));
  EXPECT_EQ(error_in("time_s\n"), "a.csv:1: depth_mm: missing, the header must name depth_mm");
  EXPECT_EQ(error_in("depth_mm,depth_mm\n"), "a.csv:1: depth_mm: the column appears twice, must appear once");
}

TEST(CsvTable, NamesTheColumnsThatAreMissingBeforeThoseThatAreUnknown) {
  const std::vector<CsvColumn> path = {{"time_s"}, {"x_m"}, {"y_m"}, {"qw", false}};
  const auto error = [&path](const std::string& content) {
    return palpate::test::rejection_of("a.csv", content, [&path](const auto& file) { CsvTable(file, path); });
  };
  EXPECT_EQ(error("t,x,y\n"),
            "a.csv:1: time_s, x_m and y_m: missing, the header must name time_s, x_m and y_m; "
            "unknown in it: t, x and y");
  EXPECT_EQ(error("time_s,x_m,y_mm\n"), "a.csv:1: column \"y_mm\": unknown, did you mean y_m?");
}

TEST(CsvTable, RefusesFilesWithoutHeaderOrRows) {
  EXPECT_EQ(error_in("# nothing\n"), "a.csv: is empty, must have a header and rows");
  EXPECT_EQ(error_in(kHeader), "a.csv: has no rows after the header");
}

TEST(CsvTable, NamesLineColumnAndValueOfWhatIsNoNumber) {
  for (const std::string bad : {"nan", "inf", "abc", "", "1.0mm", "0x10", "1e999", "1 2", "1.1e9"}) {
    EXPECT_EQ(error_in(std::string("\n") + kHeader + "0,1\n1," + bad + "\n"),
              "a.csv:4: depth_mm = " + bad + ": must be a finite number up to 1e9");
  }
}

TEST(CsvTable, RefusesRowsOfAnotherLengthThanTheHeader) {
  EXPECT_EQ(error_in(kHeader + "1\n"), "a.csv:2: the row has 1 values, must have 2 as the header");
  EXPECT_EQ(error_in(kHeader + "1,2,3\n"), "a.csv:2: the row has 3 values, must have 2 as the header");
}

TEST(CsvTable, RefusesAnEmptyName) {
  EXPECT_EQ(error_in("depth_mm,specimen\n1,\n"), "a.csv:2: specimen: empty, must be a name");
}

TEST(CsvTable, DistinguishesDecimalCommasAndSemicolonsFromBadRows) {
  EXPECT_THAT(error_in("time_s;depth_mm\n0,5;0,1\n"), HasSubstr("a.csv:1: semicolons"));
  EXPECT_THAT(error_in(kHeader + "0,5,0,1\n"), HasSubstr("a decimal comma must be a point"));
}

TEST(CsvTable, RefusesALineBeyond64KiB) {
  EXPECT_EQ(error_in(kHeader + "0,1\n" + std::string(70'000, '1') + "\n"),
            "a.csv:3: the line is longer than 64 KiB, is this a CSV file?");
}

TEST(CsvTable, RefusesMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_THROW(CsvTable(folder.path() / "none.csv", kColumns), InputError);
  EXPECT_THROW(CsvTable(folder.path(), kColumns), InputError);
}

}  // namespace
}  // namespace palpate
