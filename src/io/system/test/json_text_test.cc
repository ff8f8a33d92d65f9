#include "io/system/json_text.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/system/json_field.h"
#include "palpate/error.h"

namespace palpate {
namespace {

using ::testing::ElementsAre;

template <typename Read>
std::string refusal_by(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no refusal";
}

std::string json_refusal(const std::string& text) {
  return refusal_by([&] { (void)parse_json(text); });
}

TEST(JsonText, IsReadUpToTheLargestNesting) {
  EXPECT_EQ(json_refusal(std::string(64, '[') + std::string(64, ']')), "no refusal");
  EXPECT_EQ(json_refusal("\n" + std::string(300'000, '[')),
            "line 2, byte 66 of 300001: is nested deeper than 64 levels");
}

TEST(JsonText, ThatIsNoneIsRefusedWithItsLineAndByteAndNoneOfItsWords) {
  EXPECT_EQ(json_refusal("{\"a\":\n secret}"), "line 2, byte 8 of 14: is no JSON");
  EXPECT_EQ(json_refusal(""), "line 1, byte 1 of 0: is no JSON");
  EXPECT_EQ(json_refusal("[1e999]"), "has a number that no double holds, must be finite");
}

TEST(JsonText, KeepsTheOrderOfMembersOnlyOfSoManyThatTheLibrarySearchesThemInTime) {
  EXPECT_EQ(parse_ordered_json(R"({"b": 1, "a": 2})").dump(), R"({"b":1,"a":2})");
  std::string many = "{\"0\": 0";
  for (int i = 1; i < 10'000; ++i) many += ",\"" + std::to_string(i) + "\": 0";
  EXPECT_EQ(parse_ordered_json(many + "}").size(), 10'000U);
  EXPECT_EQ(refusal_by([&] { (void)parse_ordered_json(many + ",\"x\": 0}"); }),
            "has more than 10000 members");
}

const nlohmann::json& sample() {
  static const nlohmann::json kSample = parse_json(
      R"({"a": {"b": [1, -2, 3.5, null]}, "text": "t\n", "flag": true, "none": null, "most": 18446744073709551615})");
  return kSample;
}

TEST(JsonField, GivesTheValueOfEachType) {
  const JsonField root(sample());
  EXPECT_EQ(root.at("a").at("b").elements()[2].number(), 3.5);
  EXPECT_EQ(root.at("a").at("b").elements()[1].whole<int>(), -2);
  EXPECT_EQ(root.at("most").whole<std::uint64_t>(), 18446744073709551615U);
  EXPECT_EQ(root.at("text").text(), "t\n");
  EXPECT_TRUE(root.at("flag").flag());
  EXPECT_FALSE(root.at("none").there());
  EXPECT_TRUE(root.has("none"));
  EXPECT_FALSE(root.has("other"));
  EXPECT_EQ(root.at("other").optional_number(), std::nullopt);
  EXPECT_TRUE(root.at("other").elements().empty());
  EXPECT_EQ(root.members().size(), 4U) << "without the one that is null";
}

TEST(JsonField, NamesWhatIsMissingOrWrongAndWhatWouldBeRight) {
  const JsonField root(sample(), "FILE: ");
  const JsonField list = root.at("a").at("b");
  EXPECT_EQ(refusal_by([&] { (void)root.at("x").at("y").number(); }), "FILE: x.y: missing, must be a number");
  EXPECT_EQ(refusal_by([&] { (void)root.at("text").number(); }), "FILE: text = \"t\\n\": must be a number");
  EXPECT_EQ(refusal_by([&] { (void)root.at("a").text(); }), "FILE: a = an object: must be a text");
  EXPECT_EQ(refusal_by([&] { (void)root.at("text").at("b"); }), "FILE: text = \"t\\n\": must be an object");
  EXPECT_EQ(refusal_by([&] { (void)root.at("text").elements(); }), "FILE: text = \"t\\n\": must be an array");
  EXPECT_EQ(refusal_by([&] { (void)list.elements()[3].flag(); }),
            "FILE: a.b[3]: missing, must be true or false");
  EXPECT_EQ(refusal_by([&] { (void)list.elements(3); }), "FILE: a.b: has 4 elements, must have at most 3");
  EXPECT_EQ(refusal_by([&] { (void)list.exactly(3); }), "FILE: a.b = an array: must be an array of 3");
  EXPECT_EQ(refusal_by([&] { (void)list.elements()[1].whole<std::uint32_t>(); }),
            "FILE: a.b[1] = -2: must be a whole number from 0 to 4294967295");
  EXPECT_EQ(refusal_by([&] { (void)list.elements()[2].whole<int>(); }),
            "FILE: a.b[2] = 3.5: must be a whole number from -2147483648 to 2147483647");
  EXPECT_EQ(refusal_by([&] { (void)root.at("most").whole<std::uint32_t>(31); }),
            "FILE: most = 18446744073709551615: must be a whole number from 0 to 31");
  EXPECT_EQ(refusal_by([&] { (void)list.elements()[0].number(2.0, 3.0); }),
            "FILE: a.b[0] = 1: must be a number from 2 to 3");
  EXPECT_EQ(refusal_by([&] { (void)list.elements()[1].positive(3.0); }),
            "FILE: a.b[1] = -2: must be a number > 0 and <= 3");
}

TEST(JsonField, ATextMayBeAnyTextAndAListOfThemIsRead) {
  const nlohmann::json json = parse_json(R"({"a": ["", "b"]})");
  EXPECT_THAT(JsonField(json).at("a").texts(), ElementsAre("", "b"));
}

}  // namespace
}  // namespace palpate
