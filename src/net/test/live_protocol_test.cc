#include "net/live_protocol.h"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "net/live_messages.h"

namespace palpate::net {
namespace {

using nlohmann::json;
using testing::HasSubstr;

template <typename Command>
Command read_as(const std::string& text) {
  LiveReference reference;
  return std::get<Command>(read_live_message(text, reference));
}

struct Refused {
  std::string code;
  std::string field;
  std::string words;
};

Refused refusal(const std::string& text) {
  LiveReference reference;
  try {
    (void)read_live_message(text, reference);
  } catch (const LiveError& error) {
    return {error.code(), error.field(), error.what()};
  }
  return {"none", "", "it was not refused: " + text};
}

void expect_refusal(const std::string& text, const std::string& code, const std::string& field,
                    const std::string& words) {
  const Refused refused = refusal(text);
  EXPECT_EQ(refused.code, code) << text << ": " << refused.words;
  EXPECT_EQ(refused.field, field) << text << ": " << refused.words;
  EXPECT_THAT(refused.words, HasSubstr(words)) << text;
  EXPECT_EQ(refused.words.find('\n'), std::string::npos) << "one line";
}

TEST(LiveProtocol, EveryCommandIsReadWithItsFields) {
  EXPECT_EQ(read_as<Hello>(R"({"palpate": "1", "do": "hello", "token": "abc"})").token, "abc");
  EXPECT_EQ(read_as<Stream>(R"({"do": "stream", "rate_Hz": 50})").rate_Hz, 50.0);
  const auto load = read_as<Load>(
      R"({"do":"load","scene":"a.toml","task":"pull","organ":"heart","organ_unit":"mm","tissue":"liver",
          "tool":"sphere:3","tool_unit":"cm","device":"emulated","rate_Hz":500,"seed":9007199254740992,
          "no_noise":true})");
  EXPECT_EQ(load.scene, "a.toml");
  EXPECT_EQ(load.task, "pull");
  EXPECT_EQ(load.organ, "heart");
  EXPECT_EQ(load.organ_unit, "mm");
  EXPECT_EQ(load.tissue, "liver");
  EXPECT_EQ(load.tool, "sphere:3");
  EXPECT_EQ(load.tool_unit, "cm");
  EXPECT_EQ(load.device, "emulated");
  EXPECT_EQ(load.rate_Hz, 500.0);
  EXPECT_EQ(load.seed, 9007199254740992U);
  EXPECT_TRUE(load.no_noise);
  (void)read_as<GetVersion>(R"({"do": "version"})");
  (void)read_as<GetState>(R"({"do": "state"})");
  (void)read_as<GetScene>(R"({"do": "scene"})");
  EXPECT_EQ(read_as<GetTool>(R"({"do": "tool"})").hand, 0U);
  EXPECT_EQ(read_as<GetTool>(R"({"do": "tool", "hand": 1})").hand, 1U);
  (void)read_as<GetPicture>(R"({"do": "picture"})");
  EXPECT_FALSE(read_as<GetSurface>(R"({"do": "surface"})").at_rest);
  EXPECT_TRUE(read_as<GetSurface>(R"({"do": "surface", "at_rest": true})").at_rest);
  EXPECT_EQ(read_as<Start>(R"({"do": "start"})").device, std::nullopt);
  EXPECT_EQ(read_as<Start>(R"({"do": "start", "device": "haply"})").device, "haply");
  (void)read_as<GetDevices>(R"({"do": "devices"})");
  EXPECT_TRUE(read_as<Record>(R"({"do": "record", "on": true})").on);
  EXPECT_FALSE(read_as<Record>(R"({"do": "record", "on": false})").on);
  (void)read_as<Stop>(R"({"do": "stop"})");
  (void)read_as<ResetFaults>(R"({"do": "reset_faults"})");
}

TEST(LiveProtocol, TheCommandsNameAndIdAreKnownAlsoWhenItIsRefused) {
  LiveReference reference;
  EXPECT_THROW((void)read_live_message(R"({"do": "stream", "id": 7})", reference), LiveError);
  EXPECT_EQ(reference.command, "stream");
  EXPECT_EQ(reference.id, "7");
  (void)read_live_message(R"({"do": "state", "id": "a\"b"})", reference);
  EXPECT_EQ(reference.id, R"("a\"b")");
  (void)read_live_message(R"({"do": "state"})", reference);
  EXPECT_EQ(reference.id, "") << "nothing is left of the message before";
}

TEST(LiveProtocol, WhatIsNoJsonIsRefusedByItsByte) {
  expect_refusal("", "json", "", "byte");
  expect_refusal("{\"do\": \"state\"", "json", "", "is no JSON");
  expect_refusal("{\"do\": nan}", "json", "", "is no JSON");
  expect_refusal("{\"do\": \"\xff\"}", "json", "", "is no JSON");
  expect_refusal("[1]", "json", "", "must be a JSON object");
  expect_refusal("\"state\"", "json", "", "must be a JSON object");
  expect_refusal(R"({"do": "stream", "rate_Hz": 1e999})", "json", "", "no double holds");
}

TEST(LiveProtocol, NestingIsBoundedBeforeAnythingIsRead) {
  const std::string deep = std::string(8000, '[') + std::string(8000, ']');
  expect_refusal(deep, "json", "", "byte 9 of 16000: is nested deeper than 8 levels");
  EXPECT_EQ(refusal(R"({"do": "state", "id": "[[[[[[[[[[[[[["})").code, "none")
      << "in a text it is no nesting";
}

TEST(LiveProtocol, AMessageIsBoundedInSize) {
  const std::string command = R"({"do": "state"})";
  EXPECT_EQ(refusal(command + std::string(kLargestRequest - command.size(), ' ')).code, "none");
  expect_refusal(command + std::string(kLargestRequest - command.size() + 1, ' '), "json", "", "16384");
}

TEST(LiveProtocol, AnUnknownCommandIsReportedWithTheNearestOne) {
  expect_refusal(R"({"do": "set_tisue"})", "command", "do", "did you mean set_tissue?");
  expect_refusal(R"({"do": 4})", "command", "do", "do = 4: must be one of");
  expect_refusal(R"({"id": 1})", "command", "do", "missing");
}

TEST(LiveProtocol, AnUnknownFieldIsReportedWithTheNearestOne) {
  expect_refusal(R"({"do": "stream", "rate_Hz": 5, "rates": 1})", "field", "rates",
                 "no field of this command");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"k1_N_pr_m": 5}})", "field", "tissue.k1_N_pr_m",
                 "did you mean k1_N_per_m?");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"contact": {"frction": 5}}})", "field",
                 "tissue.contact.frction", "did you mean friction?");
  expect_refusal(R"({"do": "set_noise", "noise": {"gain": 5}})", "field", "noise.gain", "no field");
}

TEST(LiveProtocol, AValueOfAnotherTypeIsReportedWithWhatWouldBeRight) {
  expect_refusal(R"({"do": "stream"})", "field", "rate_Hz", "missing");
  expect_refusal(R"({"do": "tool", "hand": 0.5})", "field", "hand", "number of a hand");
  expect_refusal(R"({"do": "tool", "hand": 4})", "field", "hand", "number of a hand");
  expect_refusal(R"({"do": "stream", "rate_Hz": "50"})", "field", "rate_Hz",
                 "rate_Hz = \"50\": must be a finite number");
  expect_refusal(R"({"do": "stream", "rate_Hz": null})", "field", "rate_Hz", "finite number");
  expect_refusal(R"({"do": "set_tissue"})", "field", "tissue", "missing");
  expect_refusal(R"({"do": "set_tissue", "tissue": 5})", "field", "tissue", "must be an object");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"law": "hard"}})", "field", "tissue.law", "smooth");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"reach": []}})", "field", "tissue.reach", "an object");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"relaxation": [{"share": 0.1}]}})", "field",
                 "tissue.relaxation[0].time_s", "missing");
  expect_refusal(R"({"do": "set_tissue", "tissue": {"relaxation": [{},{},{},{}]}})", "field",
                 "tissue.relaxation", "at most three");
  expect_refusal(R"({"do": "set_noise", "noise": {"enabled": 1}})", "field", "noise.enabled",
                 "true or false");
  expect_refusal(R"({"do": "set_noise"})", "field", "noise", "missing");
  expect_refusal(R"({"do": "load", "organ": ""})", "field", "organ", "1 to 1024 bytes");
  expect_refusal("{\"do\": \"load\", \"organ\": \"a\\nb\"}", "field", "organ", "without control characters");
  expect_refusal(R"({"do": "load", "no_noise": "yes"})", "field", "no_noise", "true or false");
  expect_refusal(R"({"do": "state", "id": [1]})", "field", "id", "a text or whole number");
  expect_refusal(R"({"do": "state", "id": 1.5})", "field", "id", "a text or whole number");
}

TEST(LiveProtocol, ANumberOutOfRangeIsReportedWithTheRange) {
  expect_refusal(R"({"do": "stream", "rate_Hz": -1})", "field", "rate_Hz", "0.1 to 1000");
  expect_refusal(R"({"do": "stream", "rate_Hz": 1000.5})", "field", "rate_Hz", "0.1 to 1000");
  expect_refusal(R"({"do": "load", "seed": -1})", "field", "seed", "2^53");
  expect_refusal(R"({"do": "load", "seed": 0.5})", "field", "seed", "whole number");
  expect_refusal(R"({"do": "load", "seed": 1e300})", "field", "seed", "2^53");
}

TEST(LiveProtocol, AMouseSendsALineOfSightOrThatItIsElsewhereAndNothingIsNoChange) {
  const auto aims = read_as<SteerMouse>(
      R"({"do":"mouse","hand":1,"ray":{"origin_m":[1,2,3],"direction":[0,0,-1.5]},"deeper_mm":-2,"grip":true})");
  EXPECT_EQ(aims.hand, 1U);
  ASSERT_TRUE(aims.ray_W);
  EXPECT_EQ(aims.ray_W->origin, Vec3(1, 2, 3));
  EXPECT_EQ(aims.ray_W->direction, Vec3(0, 0, -1)) << "of unit length";
  EXPECT_FALSE(aims.elsewhere);
  EXPECT_DOUBLE_EQ(aims.deeper, -2e-3);
  EXPECT_EQ(aims.grip, true);
  EXPECT_TRUE(read_as<SteerMouse>(R"({"do":"mouse","ray":null})").elsewhere);
  const auto nothing = read_as<SteerMouse>(R"({"do":"mouse"})");
  EXPECT_FALSE(nothing.ray_W || nothing.elsewhere || nothing.grip || nothing.park);
  EXPECT_EQ(nothing.deeper, 0.0);
  expect_refusal(R"({"do":"mouse","ray":{"origin_m":[0,0,101],"direction":[0,0,1]}})", "field",
                 "ray.origin_m", "within 100 m");
  for (const char* direction : {"[0,0,0]", "[0,0,3]", "[1e308,1e308,0]"}) {
    expect_refusal(std::string(R"({"do":"mouse","ray":{"origin_m":[0,0,0],"direction":)") + direction + "}}",
                   "field", "ray", "a direction of length 1");
  }
  expect_refusal(R"({"do":"mouse","ray":{"origin_m":[0,0,0]}})", "field", "ray", "a direction of length 1");
  expect_refusal(R"({"do":"mouse","ray":{"direction":[0,0,1],"origin":[0,0,0]}})", "field", "ray.origin",
                 "did you mean origin_m?");
  expect_refusal(R"({"do":"mouse","ray":[0,0,0]})", "field", "ray", "must be an object");
  expect_refusal(R"({"do":"record"})", "field", "on", "missing");
}

TEST(LiveProtocol, AGamepadSendsItsSticksTriggersAndButtonsWithinTheirRanges) {
  const auto pad = read_as<SteerGamepad>(
      R"({"do":"gamepad","hand":1,"way":[0.5,0,-1],"press":0.25,"close":1,"buttons":9})");
  EXPECT_EQ(pad.hand, 1U);
  EXPECT_EQ(pad.way_W, Vec3(0.5, 0.0, -1.0));
  EXPECT_EQ(pad.press, 0.25);
  EXPECT_EQ(pad.close, 1.0);
  EXPECT_EQ(pad.buttons, 9U);
  EXPECT_EQ(read_as<SteerGamepad>(R"({"do":"gamepad"})").way_W, Vec3(0.0, 0.0, 0.0)) << "at rest";
  expect_refusal(R"({"do":"gamepad","way":[2,1,0]})", "field", "way", "no longer than 2");
  expect_refusal(R"({"do":"gamepad","press":1.5})", "field", "press", "0 to 1");
  expect_refusal(R"({"do":"gamepad","close":-0.1})", "field", "close", "0 to 1");
  expect_refusal(R"({"do":"gamepad","buttons":16})", "field", "buttons", "0 to 15");
}

TEST(LiveProtocol, AnotherVersionIsRefusedByName) {
  expect_refusal(R"({"palpate": "2", "do": "hello"})", "version", "palpate", "must be \"1\"");
  expect_refusal(R"({"palpate": 1, "do": "hello"})", "version", "palpate", "palpate = 1");
  expect_refusal(R"({"do": "hello"})", "version", "palpate", "missing");
}

TEST(LiveProtocol, NoiseIsSetByItsGainOrByTheUsersThresholdAndNotByHalves) {
  const auto by_threshold = read_as<SetNoise>(
      R"({"do":"set_noise","noise":{"user_threshold_N":0.02,"share_of_threshold":0.6,"threshold_mm":5}})");
  const haptics::LiveNoise noise = edited(haptics::LiveNoise{}, by_threshold.edit);
  EXPECT_NEAR(noise.gain, 0.6 * 0.02 * 5e-3, 1e-18) << "sigma in contact is gain over threshold";
  expect_refusal(R"({"do":"set_noise","noise":{"user_threshold_N":0.02}})", "field",
                 "noise.share_of_threshold", "together");
  expect_refusal(R"({"do":"set_noise","noise":{"user_threshold_N":1,"share_of_threshold":1,"gain_N_m":1}})",
                 "field", "noise.share_of_threshold", "together");
}

TEST(LiveProtocol, AnInclusionIsSelectedByNameOrByNumberAndNotByBoth) {
  const auto by_number = read_as<SetInclusion>(
      R"({"do":"set_inclusion","inclusion":{"number":2,"position_mm":[1,-2,30],"stiffness_ratio":4}})");
  EXPECT_EQ(by_number.edit.number, 2U);
  EXPECT_FALSE(by_number.edit.name);
  EXPECT_LT((*by_number.edit.centre_S - Vec3(1e-3, -2e-3, 30e-3)).norm(), 1e-15);
  EXPECT_EQ(by_number.edit.ratio, 4.0);
  const auto by_name = read_as<SetInclusion>(R"({"do":"set_inclusion","inclusion":{"name":"nodule"}})");
  EXPECT_EQ(by_name.edit.name, "nodule");
  EXPECT_FALSE(by_name.edit.number || by_name.edit.centre_S || by_name.edit.ratio);
  expect_refusal(R"({"do":"set_inclusion"})", "field", "inclusion", "missing");
  expect_refusal(R"({"do":"set_inclusion","inclusion":{"stiffness_ratio":4}})", "field", "inclusion.name",
                 "name or number");
  expect_refusal(R"({"do":"set_inclusion","inclusion":{"name":"a","number":1}})", "field", "inclusion.name",
                 "not both");
  for (const char* number : {"0", "9", "1.5", "-1", "1e300", "\"1\"", "null"}) {
    expect_refusal(std::string(R"({"do":"set_inclusion","inclusion":{"number":)") + number + "}}", "field",
                   "inclusion.number", "a whole number from 1 to 8");
  }
  for (const char* position : {"[1,2]", "[1,2,3,4]", "5", "[1,2,null]", "{}"}) {
    expect_refusal(
        std::string(R"({"do":"set_inclusion","inclusion":{"number":1,"position_mm":)") + position + "}}",
        "field", "inclusion.position_mm", "an array of three numbers");
  }
  expect_refusal(R"({"do":"set_inclusion","inclusion":{"number":1,"stifness_ratio":4}})", "field",
                 "inclusion.stifness_ratio", "did you mean stiffness_ratio?");
}

TEST(LiveProtocol, ALoadNamesPresetsOfInclusionsAndNoneReplacesTheScenes) {
  using testing::ElementsAre;
  EXPECT_THAT(read_as<Load>(R"({"do":"load","inclusions":["nodule","cyst"]})").inclusions,
              ElementsAre("nodule", "cyst"));
  EXPECT_THAT(read_as<Load>(R"({"do":"load","inclusions":[]})").inclusions, ElementsAre("none"));
  EXPECT_THAT(read_as<Load>(R"({"do":"load"})").inclusions, ElementsAre()) << "the scene's stay";
  for (const char* wrong : {"\"nodule\"", "[1]", "[\"a\",\"a\",\"a\",\"a\",\"a\",\"a\",\"a\",\"a\",\"a\"]"}) {
    expect_refusal(std::string(R"({"do":"load","inclusions":)") + wrong + "}", "field", "inclusions",
                   "an array of at most 8 names");
  }
}

TEST(LiveProtocol, ATissueStaysWhereAnEditDoesNotNameIt) {
  const model::TissueParameters heart = model::tissue_preset("heart");
  const auto edit = read_as<SetTissue>(
      R"({"do":"set_tissue","tissue":{"k1_N_per_m":33,"rest_length_mm":12.5,"contact":{"friction":0.1}}})");
  const model::TissueParameters made = edited(heart, edit.edit);
  EXPECT_EQ(made.k1, 33.0);
  EXPECT_EQ(made.rest_length, 12.5 * 1e-3);
  EXPECT_EQ(made.contact.friction, 0.1);
  EXPECT_EQ(made.beta, heart.beta);
  EXPECT_EQ(made.name, "heart");
}

TEST(LiveProtocol, AnEditedTissueKeepsTheRadiusOfItsSourceForASizeExponentNowOrLater) {
  model::TissueParameters tissue = model::tissue_preset("heart");
  tissue.source = model::SourceParameters{"ball", 3e-3};
  const auto edit = read_as<SetTissue>(R"({"do":"set_tissue","tissue":{"k1_N_per_m":33}})");
  model::TissueParameters stiffer = edited(tissue, edit.edit);
  EXPECT_EQ(stiffer.source->radius, 3e-3);
  EXPECT_EQ(stiffer.source->indenter, "");
  const auto sized = read_as<SetTissue>(R"({"do":"set_tissue","tissue":{"size_exponent":0.5}})");
  stiffer = edited(stiffer, sized.edit);
  EXPECT_NO_THROW(model::validate(stiffer));
  EXPECT_EQ(stiffer.source->radius, 3e-3);
  tissue.size_exponent = 0.5;
  EXPECT_EQ(edited(tissue, edit.edit).source->radius, 3e-3);
  EXPECT_EQ(edited(tissue, edit.edit).max_depth, 15e-3);
}

TEST(LiveProtocol, APresetComesFirstAndANullTangentialStiffnessIsTheDefault) {
  model::TissueParameters stiff = model::tissue_preset("heart");
  stiff.contact.tangential_stiffness = 500.0;
  const auto null =
      read_as<SetTissue>(R"({"do":"set_tissue","tissue":{"contact":{"tangential_N_per_m":null}}})");
  EXPECT_FALSE(edited(stiff, null.edit).contact.tangential_stiffness);
  const auto preset = read_as<SetTissue>(R"({"do":"set_tissue","tissue":{"preset":"liver","beta":3.5}})");
  const model::TissueParameters made = edited(stiff, preset.edit);
  EXPECT_EQ(made.name, "liver");
  EXPECT_EQ(made.beta, 3.5);
  EXPECT_EQ(made.k1, model::tissue_preset("liver").k1);
  const auto wrong = read_as<SetTissue>(R"({"do":"set_tissue","tissue":{"preset":"lung"}})");
  EXPECT_THROW((void)edited(stiff, wrong.edit), InputError);
}

TEST(LiveProtocol, ATissueThatIsWrittenIsReadAgainAsTheSame) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> some(0.01, 100.0);
  for (int i = 0; i < 200; ++i) {
    model::TissueParameters tissue = model::tissue_preset("liver");
    for (const model::TissueField& field : model::kTissueFields) {
      if (!field.optional() || i % 2 == 0) field.at.set(tissue, some(random) * field.unit.si);
    }
    for (int term = 0; term < i % 4; ++term) tissue.relaxation.push_back({some(random), some(random)});
    tissue.law = i % 3 == 0 ? model::LawKind::kSmooth : model::LawKind::kLayered;
    const std::string written = tissue_json(tissue).dump();
    const auto command = read_as<SetTissue>(R"({"do":"set_tissue","tissue":)" + written + "}");
    const model::TissueParameters again = edited(model::tissue_preset("heart"), command.edit);
    for (const model::TissueField& field : model::kTissueFields) {
      EXPECT_EQ(field.at.get(again).has_value(), field.at.get(tissue).has_value()) << field.key;
      const double value = field.in_force(tissue);
      EXPECT_NEAR(field.in_force(again), value, 3e-16 * value) << field.key;  // rounding of the unit
    }
    EXPECT_EQ(again.law, tissue.law);
    EXPECT_EQ(again.name, tissue.name);
    EXPECT_EQ(again.relaxation, tissue.relaxation);
  }
}

TEST(LiveProtocol, AnyCutOrSpoiledMessageIsReadOrRefusedInOneLine) {
  const std::string whole =
      R"({"do":"set_tissue","id":"x","tissue":{"preset":"liver","k1_N_per_m":2.5e1,"reach":{"bar_ratio":2},)"
      R"("relaxation":[{"share":0.1,"time_s":1}],"contact":{"tangential_N_per_m":null}}})";
  std::mt19937_64 random(1);
  for (int i = 0; i < 5000; ++i) {
    std::string spoiled = whole.substr(0, random() % (whole.size() + 1));
    for (int changes = 0; changes < i % 4 && !spoiled.empty(); ++changes) {
      spoiled[random() % spoiled.size()] = static_cast<char>(random());
    }
    const Refused refused = refusal(spoiled);
    EXPECT_EQ(refused.words.find_first_of("\r\n") == std::string::npos || refused.code == "none", true);
  }
}

}  // namespace
}  // namespace palpate::net
