#include "io/system/nesting.h"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// `text` with `times` copies of `part` in place of "*".
std::string repeated(std::string text, const std::string& part, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += part;
  return text.replace(text.find('*'), 1, all);
}

/// The largest number of copies of `part` in `text` that kMaxNesting levels allow.
int most_copies(const std::string& text, const std::string& part) {
  int copies = 0;
  while (copies < 1000 && !toml_nested_deeper_at(repeated(text, part, copies + 1), kMaxNesting)) ++copies;
  return copies;
}

TEST(TomlNesting, EachPartOfADottedKeyIsALevel) {
  EXPECT_EQ(most_copies("*a = 1", "a."), 63);
  EXPECT_EQ(most_copies("*a = 1", "a . "), 63);
  EXPECT_EQ(most_copies("*a = 1", "\"a\"."), 63);
  EXPECT_EQ(most_copies("*a = 1", "'a.\"b'."), 63);
}

TEST(TomlNesting, ATableHeaderCountsForTheLinesBelowIt) {
  EXPECT_EQ(most_copies("[*a]", "a."), 62) << "its keys are one level deeper";
  EXPECT_EQ(most_copies("[[*a]]", "a."), 62);
  EXPECT_EQ(most_copies("\xef\xbb\xbf[*a]", "a."), 62) << "after a byte order mark";
  EXPECT_EQ(most_copies("[a.b.c]\n*a = 1", "a."), 60);
  EXPECT_EQ(most_copies("[a.b.c]\n[a]\n*a = 1", "a."), 62) << "until the next header";
  EXPECT_EQ(most_copies("  [a.b.c] # [x]\n\n*a = 1", "a."), 60);
}

TEST(TomlNesting, ArraysAndInlineTablesAreLevels) {
  EXPECT_EQ(most_copies("a = *", "["), 63);
  EXPECT_EQ(most_copies("a = *", "{a="), 63);
  EXPECT_EQ(most_copies("a = *", "{a.b="), 31) << "1 + 2 for each";
  EXPECT_EQ(most_copies("a.b = [*1]", "["), 61);
}

TEST(TomlNesting, WhatIsClosedCountsNoLonger) {
  EXPECT_EQ(most_copies("*", "a.b = [[1.5], [2.5]]\n"), 1000);
  EXPECT_EQ(most_copies("*", "[a.b.c]\nd = { e = 1.0 }\n"), 1000);
  EXPECT_EQ(most_copies("a = [*]", "1.5, "), 1000) << "the dots of numbers";
  EXPECT_EQ(most_copies("a = [*]", "{ a.b = 1 },\n"), 1000);
}

TEST(TomlNesting, StringsAndCommentsHaveNoLevels) {
  EXPECT_EQ(most_copies("a = \"*\"", "[.\\\""), 1000);
  EXPECT_EQ(most_copies("a = '*'", "[.\\"), 1000);
  EXPECT_EQ(most_copies("a = \"\"\"*\"\"\"", "[.\n\"\" \\\"\"\""), 1000);
  EXPECT_EQ(most_copies("a = '''*'''", "[.\n'' \\"), 1000);
  EXPECT_EQ(most_copies("a = 1 # *", "[.\""), 1000);
}

TEST(TomlNesting, WhatFollowsAStringOrCommentIsCounted) {
  const std::string deep = std::string(64, '[');
  for (const std::string before : {"a = \"\"\n", "a = '\\'\n", "a = \"\\\\\"\n", "a = \"\"\"b\"\"\"\"\"\n",
                                   "a = ''''b'''''\n", "a = \"\"\"\"\"\"\n", "a = '''\n'\n'''\n", "# \"\n",
                                   "a = [\n# ]\n]\n", "a = '\"'\n", "a = \"#\"\n"}) {
    EXPECT_EQ(toml_nested_deeper_at(before + "b = " + deep, kMaxNesting), before.size() + 4 + 63) << before;
  }
}

TEST(TomlNesting, ATextThatIsCutOffAnywhereIsRead) {
  const std::string text = "[a.\"b\"]\nc = [{d = '''e'''}, \"\"\"f\\\"\"\"\"] # g\n";
  for (std::size_t length = 0; length <= text.size(); ++length) {
    EXPECT_FALSE(toml_nested_deeper_at(text.substr(0, length), kMaxNesting)) << length;
  }
}

TEST(JsonNesting, BracketsCountOutsideStrings) {
  EXPECT_FALSE(json_nested_deeper_at(R"({"a[[[\"[[": [1]})", 2));
  EXPECT_EQ(json_nested_deeper_at(R"({"a": [[1]]})", 2), 7U);
  EXPECT_FALSE(json_nested_deeper_at("[[],[],[]]", 2));
}

}  // namespace
}  // namespace palpate
