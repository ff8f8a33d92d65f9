#include "core/base/charconv.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::string text_of(double value) {
  std::array<char, 32> text{};
  return {text.data(), by_printf::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string text_of_the_library(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

TEST(NumbersByPrintf, AreWrittenAsTheLibraryWritesThem) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
  for (const double value : {0.0, -0.0, 1.0, 0.1, -2.5e-3, 1e4, 1e5, 1e21, 1e22, 123456789012345678.0,
                             1.0 / 3.0, kLargest, kSmallest, -1e-310, HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(text_of(value), text_of_the_library(value));
  }
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const double value = bit_cast<double>(static_cast<std::uint64_t>(random()));
    if (std::isnan(value)) continue;
    EXPECT_EQ(text_of(value), text_of_the_library(value));
  }
}

TEST(NumbersByPrintf, ReadBackToTheSameBits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 20'000; ++i) {
    // Also powers of two, whose text may have one digit more than needed.
    const double value =
        i < 2000 ? std::ldexp(1.0, i - 1000) : bit_cast<double>(static_cast<std::uint64_t>(random()));
    if (!std::isfinite(value)) continue;
    const std::string text = text_of(value);
    double read = 0.0;
    const auto [end, error] = by_printf::from_chars(text.data(), text.data() + text.size(), read);
    EXPECT_EQ(error, std::errc{});
    EXPECT_EQ(end, text.data() + text.size());
    EXPECT_EQ(bit_cast<std::uint64_t>(read), bit_cast<std::uint64_t>(value)) << text;
  }
}

TEST(NumbersByPrintf, AreReadAsTheLibraryReadsThem) {
  for (const std::string text : {"",       "-",      "+1",  ".",   ".5",        "1.e5",  "1e",     "1e+",
                                 "0x10",   " 1",     "1 2", "-0",  "0e999",     "1e400", "-1e400", "1e-400",
                                 "4e-325", "1e-310", "in",  "INF", "-infinity", "nan",   "-nan"}) {
    double read = 7.0;
    double wanted = 7.0;
    const auto got = by_printf::from_chars(text.data(), text.data() + text.size(), read);
    const auto want = std::from_chars(text.data(), text.data() + text.size(), wanted);
    EXPECT_EQ(got.ec, want.ec) << text;
    EXPECT_EQ(got.ptr, want.ptr) << text;
    EXPECT_TRUE(read == wanted || (std::isnan(read) && std::isnan(wanted))) << text;
  }
}

}  // namespace
}  // namespace palpate
