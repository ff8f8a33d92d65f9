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

TEST(CsvTable, ATextIsQuotedWhereACellNeedsIt) {
  EXPECT_EQ(csv_cell("soft part"), "soft part");
  EXPECT_EQ(csv_cell("left, upper"), "\"left, upper\"");
  EXPECT_EQ(csv_cell("a \"nodule\""), "\"a \"\"nodule\"\"\"");
  EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_cell("a\rb"), "\"a\rb\"");
  EXPECT_EQ(csv_cell(""), "");
  EXPECT_EQ(csv_quoted(""), "\"\"");
  EXPECT_EQ(csv_quoted("soft"), "\"soft\"");
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
  EXPECT_EQ(depths_in("sep=;\r\ndepth_mm;specimen\r\n1;a\r\n2;a\r\n"), wanted) << "for Excel";
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
  // An export's header names many more.
  EXPECT_EQ(error("tick,time,hand,phase,depth,layer,force,noise\n"),
            "a.csv:1: time_s, x_m and y_m: missing, the header must name time_s, x_m and y_m; "
            "unknown in it: tick, time, hand, phase, depth and 3 others");
  EXPECT_EQ(
      error("tick,hand,phase,time_s,depth\n"),
      "a.csv:1: x_m and y_m: missing, the header must name time_s, x_m and y_m; unknown in it: tick, hand, "
      "phase and depth; the file is the ticks of a recording as CSV: palpate export wrote it; commands read "
      "the recording (.h5) itself");
  EXPECT_EQ(error("time_s,x_m,ym\n"), "a.csv:1: column \"ym\": unknown, did you mean y_m?");
  EXPECT_EQ(error("time_s,x_m,y_mm\n"),
            "a.csv:1: column \"y_mm\": unknown, did you mean y_m, with values in m, not mm?");
}

TEST(CsvTable, AsksForAConversionWhereOnlyTheUnitOfANameDiffers) {
  EXPECT_EQ(error_in("time_s,depth_um\n"),
            "a.csv:1: column \"depth_um\": unknown, did you mean depth_mm, with values in mm, not um?");
  EXPECT_EQ(error_in("depth_mm,time_ms\n"),
            "a.csv:1: column \"time_ms\": unknown, did you mean time_s, with values in s, not ms?");
  const std::vector<CsvColumn> path = {{"time_s"}, {"x_m"}, {"y_m"}};
  EXPECT_EQ(
      palpate::test::rejection_of("a.csv", "time_s,x_mm,y_mm\n",
                                  [&path](const auto& file) { CsvTable(file, path); }),
      "a.csv:1: x_m and y_m: missing, the header must name time_s, x_m and y_m; unknown in it: x_mm and "
      "y_mm, with values in m, not mm");
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

TEST(CsvTable, RefusesARowThatBeginsWithAnErrorOfExcel) {
  for (const std::string bad : {"#N/A", "#VALUE!", "#DIV/0!", "#REF!", "#NUM!", "#NAME?", "#NULL!"})
    EXPECT_EQ(error_in(kHeader + bad + ",1\n"),
              "a.csv:2: time_s = " + bad + ": must be a finite number up to 1e9");
}

TEST(CsvTable, RefusesRowsOfAnotherLengthThanTheHeader) {
  EXPECT_EQ(error_in(kHeader + "1\n"), "a.csv:2: the row has 1 values, must have 2 as the header");
  EXPECT_EQ(error_in(kHeader + "1,2,3\n"), "a.csv:2: the row has 3 values, must have 2 as the header");
}

TEST(CsvTable, RefusesAnEmptyName) {
  EXPECT_EQ(error_in("depth_mm,specimen\n1,\n"), "a.csv:2: specimen: empty, must be a name");
}

TEST(CsvTable, ReadsSemicolonsAndTabsWithEitherDecimalMark) {
  const std::vector<double> wanted = {0.1, -1.234};
  EXPECT_EQ(depths_in("time_s;depth_mm\n0,5;0,1\n1,5;-1,234\n"), wanted);
  EXPECT_EQ(depths_in("time_s;depth_mm\n0.5;0.1\n1.5;-1.234\n"), wanted);
  EXPECT_EQ(depths_in("time_s\tdepth_mm\n0,5\t0,1\n1,5\t-1,234\n"), wanted);
  EXPECT_EQ(depths_in("time_s\tdepth_mm\n0.5\t0.1\n1.5\t-1.234\n"), wanted);
  EXPECT_EQ(depths_in("time_s;depth_mm\n1;2\n3;4\n"), (std::vector<double>{2.0, 4.0}));
  EXPECT_EQ(depths_in("depth_mm;specimen\n1,5e-1;a,b\n"), std::vector<double>{0.15});
}

TEST(CsvTable, RefusesMarksThatMayBeDecimalOrOfThousands) {
  EXPECT_THAT(error_in("time_s;depth_mm\n1;1,234\n2;12,500\n"),
              HasSubstr("a.csv:2: depth_mm = 1,234: its mark may be a decimal one or one of thousands"));
  EXPECT_THAT(error_in("time_s;depth_mm\n1;1.234\n"), HasSubstr("one of thousands"));
  EXPECT_THAT(error_in("time_s\tdepth_mm\n1\t1,234\n"), HasSubstr("one of thousands"));
  EXPECT_THAT(error_in("time_s;depth_mm\n0,5;1.5\n"),
              HasSubstr("depth_mm = 1.5: must have the decimal mark of the numbers before it, a comma"));
  EXPECT_THAT(error_in("time_s;depth_mm\n0.5;1,5\n"), HasSubstr("the numbers before it, a point"));
  EXPECT_THAT(error_in("time_s;depth_mm\n0;1,234.5\n"), HasSubstr("must be a finite number"));
  EXPECT_THAT(error_in("time_s;depth_mm\n0;1,2,3\n"), HasSubstr("must be a finite number"));
  EXPECT_THAT(error_in(kHeader + "0.5,\"1,234\"\n"), HasSubstr("the numbers before it, a point"));
}

TEST(CsvTable, DistinguishesDecimalCommasFromBadRows) {
  EXPECT_THAT(error_in(kHeader + "0,5,0,1\n"), HasSubstr("a decimal comma must be a point"));
}

TEST(CsvTable, ReadsCellsInQuotationMarks) {
  const TemporaryFolder folder;
  CsvTable table(folder.write("a.csv", "\"specimen\" , \"depth_mm\"\r\n\"left, \"\"A\"\"\",\"0.5\"\r\n"),
                 kColumns);
  ASSERT_TRUE(table.next_row());
  EXPECT_EQ(table.number(kDepth), 0.5);
  EXPECT_EQ(table.text(kName), "left, \"A\"");
  EXPECT_EQ(depths_in("\"depth_mm\"\n\"0,5\"\n"), std::vector<double>{0.5});
  EXPECT_THAT(error_in("depth_mm,specimen\n1,\"a\n"),
              HasSubstr("a.csv:2: a cell in quotation marks must end in its line"));
  EXPECT_THAT(error_in("depth_mm,specimen\n1,\"a\"b\n"),
              HasSubstr("a.csv:2: a: has text behind its quotation"));
}

TEST(CsvTable, IgnoresRowNamesOfRAndPandas) {
  const std::vector<double> wanted = {0.5, 1.5};
  EXPECT_EQ(depths_in("\"\",\"depth_mm\"\n\"1\",0.5\n\"2\",1.5\n"), wanted);            // write.csv
  EXPECT_EQ(depths_in("\"time_s\",\"depth_mm\"\n\"1\",7,0.5\n\"2\",8,1.5\n"), wanted);  // write.table
  EXPECT_EQ(depths_in("time_s\tdepth_mm\nrow 1\t7\t0.5\nrow 2\t8\t1.5\n"), wanted);
  EXPECT_EQ(depths_in("\"time_s\";\"depth_mm\"\n\"1\";7;0,5\n\"2\";8;1,5\n"), wanted);  // write.csv2
  EXPECT_EQ(depths_in(",depth_mm\n0,0.5\n1,1.5\n"), wanted);                            // to_csv
  EXPECT_EQ(depths_in("\tdepth_mm\n0\t0.5\n1\t1.5\n"), wanted);
  EXPECT_EQ(depths_in("Unnamed: 0,depth_mm\n0,0.5\n1,1.5\n"), wanted);
}

TEST(CsvTable, RefusesAFurtherValueThatMayBeNoRowName) {
  EXPECT_EQ(error_in(kHeader + "0,5,1\n"), "a.csv:2: the row has 3 values, must have 2 as the header");
  EXPECT_THAT(error_in("time_s\tdepth_mm\n1\t0\t0.5\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "\"0\",\"1\",\"2\"\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "0,1\n\"2\",1,2\n"), HasSubstr("a.csv:3: the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "\"1\",0,1.5\n2,3,4\n"), HasSubstr("a.csv:3: the row has 3 values"));
}

TEST(CsvTable, RefusesARowWithoutANameInAFileWithRowNames) {
  EXPECT_EQ(error_in(kHeader + "\"1\",0,1.5\n\"2\",3\n"),
            "a.csv:3: the row has 2 values, must have 2 as the header, behind a row name");
}

TEST(CsvTable, TakesNoTextOfTheFirstColumnAsARowName) {
  const std::string header = "specimen,time_s,depth_mm\n";
  EXPECT_EQ(error_in(header + "\"liver\",1,2,5\n"),
            "a.csv:2: the row has 4 values, must have 3 as the header");
  EXPECT_THAT(error_in("specimen\tdepth_mm\n\"liver\"\t1\t2\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in("\"\",depth_mm\n\"1\",0,5\n"), HasSubstr("the row has 3 values, must have 2"));
}

TEST(CsvTable, RefusesARowNameWhereADecimalCommaCouldMakeAFurtherCell) {
  const std::string doubt =
      "a.csv:2: the row has 3 values, must have 2 as the header: the first may be a row name, or a comma a "
      "decimal one, and no number has a decimal point";
  EXPECT_EQ(error_in(kHeader + "NA,7,5\n"), doubt);
  EXPECT_EQ(error_in(kHeader + "\"1\",7,5\n\"2\",8,5\n"), doubt);
  EXPECT_EQ(error_in(kHeader + "NA,7,5e-3\n"), doubt);
  EXPECT_THAT(error_in("depth_mm\n-,5\n"), HasSubstr("a.csv:2: the row has 2 values, must have 1"));
  EXPECT_THAT(error_in("depth_mm\n1 000,5\n"), HasSubstr("a.csv:2: the row has 2 values, must have 1"));
  EXPECT_THAT(error_in(kHeader + "\"0,5\",1,2\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "\"\",7,5\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "NA,7,5\nNA,\"0,5\",1\n"), HasSubstr("the numbers before it, a point"));
  EXPECT_EQ(depths_in(kHeader + "\"1\",0,0\n\"2\",8,1.5\n"), (std::vector<double>{0.0, 1.5}));
}

TEST(CsvTable, IgnoresASeparatorAtTheEndOfLines) {
  EXPECT_EQ(depths_in("time_s,depth_mm,\n0,0.5,\n1,1.5\n"), (std::vector<double>{0.5, 1.5}));
  EXPECT_THAT(error_in("time_s,depth_mm,\n0,0.5,7\n"), HasSubstr("the row has 3 values"));
  EXPECT_THAT(error_in(kHeader + "0,5,\n"), HasSubstr("the row has 3 values"));
}

TEST(CsvTable, IgnoresARowOfTheColumnsUnitsAndNoOther) {
  EXPECT_EQ(depths_in("time_s,depth_mm,specimen\ns,mm,name\n0,0.5,a\n"), std::vector<double>{0.5});
  EXPECT_EQ(depths_in("time_s,depth_mm\n[s],(mm)\n0,0.5\n"), std::vector<double>{0.5});
  EXPECT_THAT(error_in(kHeader + "s,m\n0,1\n"),
              HasSubstr("a.csv:2: depth_mm: the row of units says m, must"));
  EXPECT_THAT(error_in(kHeader + "a,b\n0,1\n"), HasSubstr("a.csv:2: time_s = a: must be a finite number"));
  EXPECT_THAT(error_in(kHeader + "0,1\ns,mm\n"), HasSubstr("a.csv:3: time_s = s: must be a finite number"));
  EXPECT_EQ(error_in(kHeader + "s,mm\n"), "a.csv: has no rows after the header");
  EXPECT_THAT(error_in(kHeader + "s,mm\ns,mm\n0,1\n"),
              HasSubstr("a.csv:3: time_s = s: must be a finite number"));
}

std::string utf16(const std::string& ascii, bool is_big) {
  std::string bytes;
  for (const char c : ascii) bytes += is_big ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

TEST(CsvTable, ReadsUtf16WithAByteOrderMark) {
  std::string rows;
  for (int n = 0; n < 9000; ++n) rows += "0.25\t" + std::to_string(n) + "\r\n";
  const std::string text = "time_s\tdepth_mm\r\n" + rows;
  const std::vector<double> little = depths_in("\xFF\xFE" + utf16(text, false));
  ASSERT_EQ(little.size(), 9000U);
  for (int n = 0; n < 9000; ++n) ASSERT_EQ(little[static_cast<std::size_t>(n)], n);
  EXPECT_EQ(depths_in("\xFE\xFF" + utf16(text, true)), little);
  EXPECT_THAT(error_in(utf16(text, false)), HasSubstr("a.csv:1: has zero bytes: must be UTF-8, or UTF-16"));
}

TEST(CsvTable, ReadsNamesInUtf16OfEveryLength) {
  const TemporaryFolder folder;
  const std::string name("\xE9\x00\xAC\x20\x3D\xD8\x00\xDE\x00\xD8\x61\x00",
                         12);  // e acute, euro, an emoji, half
  CsvTable table(folder.write("a.csv", "\xFF\xFE" + utf16("depth_mm,specimen\n1,", false) + name), kColumns);
  ASSERT_TRUE(table.next_row());
  EXPECT_EQ(table.text(kName),
            "\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\xEF\xBF\xBD"
            "a");
}

TEST(CsvTable, RefusesLinesThatEndInCarriageReturnsAlone) {
  EXPECT_EQ(error_in("depth_mm\r1\r2\r"), "a.csv:1: lines end in CR alone, must end in LF or CR LF");
}

TEST(CsvTable, ReadsColumnsBetweenBlanks) {
  EXPECT_EQ(depths_in("time_s depth_mm\n 0.5   0.1\n1.5 \t-1.234 \n"), (std::vector<double>{0.1, -1.234}));
  EXPECT_EQ(depths_in("\"time_s\" \"depth_mm\"\n\"1\" 7 0.5\n\"2\" 8 1.5\n"),  // write.table
            (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(error_in("time_s depth_mm\n1 7 0.5\n"),
            "a.csv:2: the row has 3 values, must have 2 as the header");
  EXPECT_THAT(error_in("time depth\n1 2\n"), HasSubstr("depth_mm: missing"));
}

TEST(CsvTable, NamesATableOfAnotherKindAndWhatReadsIt) {
  EXPECT_THAT(error_in("displacement_mm,force_N\n0,1\n"),
              HasSubstr("the file is a measured curve (CSV): palpate fit and validate read it"));
  EXPECT_THAT(error_in("[scene]\nname = \"a\"\n"),
              HasSubstr("a.csv: is a scene, must be a CSV file; palpate run"));
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
