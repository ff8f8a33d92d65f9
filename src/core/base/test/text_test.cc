#include "core/base/text.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate {
namespace {

TEST(Shortest, ReadsBackToTheSameBits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100'000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (value != value) continue;
    const std::string text = shortest(value);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)),
              std::bit_cast<std::uint64_t>(value))
        << text;
  }
}

TEST(OneLine, HasABlankForEveryControlCharacterAndKeepsTheRest) {
  EXPECT_EQ(one_line("a\r\nb\tc\x7f"), "a  b c ");
  EXPECT_EQ(one_line("\xc3\xa4 ~"), "\xc3\xa4 ~") << "letters beyond ASCII stay";
}

TEST(Brief, KeepsSoManyDigitsThatMatter) {
  EXPECT_EQ(brief(0.123456), "0.1235");
  EXPECT_EQ(brief(-123456.0), "-1.235e+05");
  EXPECT_EQ(brief(2.0), "2");
  EXPECT_EQ(brief(0.123456, 2), "0.12");
}

TEST(DecimalsOfStep, AreThoseThatTellLabelsApart) {
  EXPECT_EQ(decimals_of_step(2.5), 1);
  EXPECT_EQ(decimals_of_step(20.0), 0);
  EXPECT_EQ(decimals_of_step(1.0), 0);
  EXPECT_EQ(decimals_of_step(0.25), 2);
  EXPECT_EQ(decimals_of_step(0.1), 1);
  EXPECT_EQ(decimals_of_step(0.1 + 0.2), 1);
  EXPECT_EQ(decimals_of_step(1.0 / 3.0), 6);
}

TEST(Percent, IsAShareOfAHundred) {
  EXPECT_EQ(percent(0.123456), "12.35 %");
  EXPECT_EQ(percent(-0.5, 0), "-50 %");
  EXPECT_EQ(percent(-1e306, 2).size(), 1U + 309U + 3U + 2U) << "sign, digits, decimals, sign of per cent";
}

TEST(Shortest, HasNoDigitTooMany) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(18.0), "18");
  EXPECT_EQ(shortest(-2.5e-7), "-2.5e-07");
  EXPECT_EQ(shortest(-0.0), "-0");
}

TEST(Shortest, NamesWhatIsNoNumber) {
  EXPECT_EQ(shortest(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(shortest(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(shortest(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(shortest(-std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(NearestWord, FindsATypingMistake) {
  const std::array<std::string, 4> known{"gallbladder", "heart", "liver", "kidney"};
  EXPECT_EQ(nearest_word("galbladder", known), "gallbladder");
  EXPECT_EQ(nearest_word("haert", known), "heart");
  EXPECT_EQ(nearest_word("liver", known), "liver");
  EXPECT_EQ(nearest_word("kidneys", known), "kidney");
}

TEST(NearestWord, IsEmptyWhenNoneIsNear) {
  const std::array<std::string, 2> known{"gallbladder", "heart"};
  EXPECT_EQ(nearest_word("xyzzy", known), "");
  EXPECT_EQ(nearest_word("anything", {}), "");
}

TEST(ParameterError, NamesFieldValueAndWhatWouldBeRight) {
  const ParameterError error("k1_N_per_m", -18.0, "finite and > 0");
  EXPECT_STREQ(error.what(), "k1_N_per_m = -18: must be finite and > 0");
  EXPECT_EQ(error.field(), "k1_N_per_m");
}

}  // namespace
}  // namespace palpate
