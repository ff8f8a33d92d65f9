#include "palpate/units.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate {
namespace {

TEST(LengthUnit, IsReadByItsName) {
  EXPECT_EQ(metres_per(parse_length_unit("mm")), 0.001);
  EXPECT_EQ(metres_per(parse_length_unit("cm")), 0.01);
  EXPECT_EQ(metres_per(parse_length_unit("m")), 1.0);
  EXPECT_EQ(metres_per(parse_length_unit("in")), 0.0254);
}

TEST(LengthUnit, IsWrittenAsItIsRead) {
  for (const LengthUnit unit :
       {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
    EXPECT_EQ(parse_length_unit(to_string(unit)), unit);
  }
}

TEST(LengthUnit, RefusesUnknownNamesAndListsTheKnownOnes) {
  for (const std::string text : {"", "MM", "ft", " mm", "mm "}) {
    try {
      static_cast<void>(parse_length_unit(text));
      FAIL() << "accepted \"" << text << '"';
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr('"' + text + '"'));
      EXPECT_THAT(error.what(), testing::HasSubstr("mm, cm, m or in"));
    }
  }
}

}  // namespace
}  // namespace palpate
