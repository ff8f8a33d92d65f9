#include "io/system/whole_json.h"

#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using Json = nlohmann::json;

template <typename Whole>
std::string refusal(const std::string& number) {
  try {
    (void)whole_number<Whole>(Json::parse("{\"count\": " + number + "}"), "count");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no refusal";
}

template <typename Whole>
class WholeNumber : public ::testing::Test {};
using Wholes = ::testing::Types<std::int8_t, std::uint8_t, int, std::uint32_t, std::int64_t, std::uint64_t>;
TYPED_TEST_SUITE(WholeNumber, Wholes);

TYPED_TEST(WholeNumber, EveryNumberOfItsTypeIsReadExactly) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1'000; ++i) {
    const auto number = static_cast<TypeParam>(random());
    EXPECT_EQ(whole_number<TypeParam>(Json{{"count", number}}, "count"), number);
  }
  for (const TypeParam number :
       {std::numeric_limits<TypeParam>::min(), std::numeric_limits<TypeParam>::max()}) {
    EXPECT_EQ(whole_number<TypeParam>(Json::parse("{\"count\": " + std::to_string(number) + "}"), "count"),
              number);
  }
}

TYPED_TEST(WholeNumber, WhatIsNoneIsRefusedWithTheRange) {
  const std::string range = ", want a whole number from " +
                            std::to_string(std::numeric_limits<TypeParam>::min()) + " to " +
                            std::to_string(std::numeric_limits<TypeParam>::max());
  EXPECT_EQ(refusal<TypeParam>("1.5"), "count is 1.5" + range);
  EXPECT_EQ(refusal<TypeParam>("2.0"), "count is 2.0" + range);
  EXPECT_EQ(refusal<TypeParam>("1e30"), "count is 1e+30" + range);
  EXPECT_EQ(refusal<TypeParam>("-1e30"), "count is -1e+30" + range);
  EXPECT_EQ(refusal<TypeParam>("\"7\""), "count is \"7\"" + range);
  EXPECT_EQ(refusal<TypeParam>("true"), "count is true" + range);
  EXPECT_EQ(refusal<TypeParam>("null"), "count is null" + range);
  EXPECT_EQ(refusal<TypeParam>("[[7]]"), "count is array" + range);
}

TEST(WholeNumberRange, OneBesideTheRangeIsRefused) {
  EXPECT_THAT(refusal<std::uint64_t>("-1"), ::testing::StartsWith("count is -1, "));
  EXPECT_THAT(refusal<std::uint64_t>("18446744073709551616"),
              ::testing::StartsWith("count is 1.8446744073709552e+19, "));
  EXPECT_THAT(refusal<std::int64_t>("9223372036854775808"),
              ::testing::StartsWith("count is 9223372036854775808, "));
  EXPECT_THAT(refusal<std::uint32_t>("4294967296"), ::testing::StartsWith("count is 4294967296, "));
  EXPECT_THAT(refusal<int>("2147483648"), ::testing::StartsWith("count is 2147483648, "));
  EXPECT_THAT(refusal<int>("-2147483649"), ::testing::StartsWith("count is -2147483649, "));
  EXPECT_THAT(refusal<std::uint8_t>("256"), ::testing::StartsWith("count is 256, "));
}

TEST(WholeNumberRange, ALongTextIsReportedInPart) {
  EXPECT_LT(refusal<int>('"' + std::string(10'000, 'a') + '"').size(), 200U);
}

}  // namespace
}  // namespace palpate
