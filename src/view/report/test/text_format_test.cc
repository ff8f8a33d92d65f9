#include <gtest/gtest.h>

#include "view/report/page.h"

namespace palpate::report {
namespace {

TEST(TextFormat, FixedRoundsToTheDigits) {
  EXPECT_EQ(fixed(12.3456, 2), "12.35");
  EXPECT_EQ(fixed(-0.5, 1), "-0.5");
  EXPECT_EQ(fixed(1000.0, 0), "1000");
}

TEST(TextFormat, FixedHasNoMinusBeforeZero) {
  EXPECT_EQ(fixed(-0.0, 0), "0");
  EXPECT_EQ(fixed(-0.004, 2), "0.00");
  EXPECT_EQ(fixed(-0.006, 2), "-0.01");
}

TEST(TextFormat, GroupsThousands) {
  EXPECT_EQ(grouped(7), "7");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(2110), "2,110");
  EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST(TextFormat, EscapesWhatHtmlReadsAsMarkup) {
  EXPECT_EQ(escaped("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(TextFormat, TellsUniversalTime) {
  EXPECT_EQ(utc_time(1'309'521'600'000'000'000), "2011-07-01 12:00:00 UTC");
}

}  // namespace
}  // namespace palpate::report
