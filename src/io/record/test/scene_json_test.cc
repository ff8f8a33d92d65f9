#include "io/record/scene_json.h"

#include <cstdint>
#include <limits>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/record/test/sample_recording.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A scene with heartbeat and a failing device, as JSON with `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  scene::Scene scene = sample_setup(1);
  scene.organ_motion.resize(1);
  scene.organ_motion[0].kind = model::OrganMotionKind::kHeartbeat;
  scene.devices[0].kind = "emulated";
  scene.devices[0].emulated.faults = {{scene::EmulatedFaultKind::kFreeze, 0.1, 0.2, 0.05}};
  scene.inclusions.resize(1);
  std::string text = scene_to_json(scene);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  try {
    (void)scene_from_json(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no refusal";
}

TEST(SceneJson, ANeedleAndItsLayersComeBackAsTheyWere) {
  scene::Scene scene = sample_setup(1);
  scene.tissue.layers = model::tissue_preset("epidural").layers;
  scene.tools[0].needle = geometry::Needle{Vec3(1e-3, 0, 80e-3), Vec3::UnitX(), 0.7e-3, 80e-3};
  const scene::Scene read = scene_from_json(scene_to_json(scene));
  EXPECT_EQ(read.tissue.layers, scene.tissue.layers);
  ASSERT_TRUE(read.tools[0].needle.has_value());
  EXPECT_EQ(read.tools[0].needle->tip, scene.tools[0].needle->tip);
  EXPECT_EQ(read.tools[0].needle->axis, scene.tools[0].needle->axis);
  EXPECT_EQ(read.tools[0].needle->diameter, 0.7e-3);
  EXPECT_EQ(read.tools[0].needle->length, 80e-3);
}

TEST(SceneJson, EveryWordThatIsNotKnownIsRefusedInTheSceneWithWhatWouldBeRight) {
  EXPECT_THAT(refusal(changed(R"("law": "smooth")", R"("law": "smoovh")")),
              AllOf(StartsWith("scene: law"), HasSubstr("smoovh"), HasSubstr("layered or smooth")));
  EXPECT_THAT(
      refusal(changed(R"("task": "pull")", R"("task": "push")")),
      AllOf(StartsWith("scene: task"), HasSubstr("push"), HasSubstr("press, pull, palpate or insert")));
  EXPECT_THAT(refusal(changed(R"("kind": "heartbeat")", R"("kind": "hiccup")")),
              AllOf(StartsWith("scene: organ.motion[0].kind"), HasSubstr("hiccup"),
                    HasSubstr("breathing or heartbeat")));
  EXPECT_THAT(refusal(changed(R"("kind": "freeze")", R"("kind": "found")")),
              AllOf(StartsWith("scene: devices[0].emulated.faults[0].kind"), HasSubstr("found")));
}

TEST(SceneJson, ASearchMakesTheRoundTrip) {
  scene::Scene scene = sample_setup(1);
  scene.task = scene::Task::kPalpate;
  scene.search = {7e-3, 5};
  const scene::Scene read = scene_from_json(scene_to_json(scene));
  EXPECT_EQ(read.task, scene::Task::kPalpate);
  EXPECT_EQ(read.search.tolerance, 7e-3);
  EXPECT_EQ(read.search.mark_button, 5U);
  std::string text = scene_to_json(scene);
  text.replace(text.find("\"mark_button\": 5"), 16, "\"mark_button\": 32");
  EXPECT_EQ(refusal(text), "scene: search.mark_button = 32: must be a whole number from 0 to 31");
}

TEST(SceneJson, ATargetMakesTheRoundTripAndOlderRecordingsHaveNone) {
  scene::Scene scene = sample_setup(1);
  scene.task = scene::Task::kInsert;
  scene.target = {"epidural space", {"dura"}};
  std::string text = scene_to_json(scene);
  EXPECT_EQ(scene_from_json(text).target.layer, "epidural space");
  EXPECT_THAT(scene_from_json(text).target.forbidden, testing::ElementsAre("dura"));
  text.replace(text.find("\"target\""), 8, "\"another\"");
  EXPECT_EQ(scene_from_json(text).target.layer, "");
}

TEST(SceneJson, APathsSpeedIsInTheRangeOfTheScenesKey) {
  const std::string speed = R"("path_speed": 1.5)";
  for (const std::string least_or_most : {"0.01", "100.0"})
    EXPECT_EQ(refusal(changed(speed, R"("path_speed": )" + least_or_most)), "no refusal");
  for (const std::string beyond : {"0.0", "0.0099", "100.1", "-1.0"}) {
    EXPECT_THAT(refusal(changed(speed, R"("path_speed": )" + beyond)),
                HasSubstr("must be a number from 0.01 to 100"));
  }
}

TEST(SceneJson, AKeyThatIsMissingAndTextThatIsNoJsonAreRefusedInTheScene) {
  EXPECT_THAT(refusal(changed(R"("beta":)", R"("beat":)")), AllOf(StartsWith("scene: "), HasSubstr("beta")));
  EXPECT_THAT(refusal("{"), StartsWith("scene: "));
}

TEST(SceneJson, ALibraryThatARecordingNamesIsForgottenSoThatNothingRunFromItLoadsCode) {
  scene::Scene scene = sample_setup(2);
  scene.devices.resize(2);
  scene.devices[0].kind = "forcedimension";
  scene.devices[0].path = "/tmp/libevil.so";
  scene.devices[1].kind = "scripted";
  scene.devices[1].path = "press.csv";
  const scene::Scene read = scene_from_json(scene_to_json(scene));
  EXPECT_EQ(read.devices[0].kind, "forcedimension");
  EXPECT_EQ(read.devices[0].path, "");
  EXPECT_EQ(read.devices[1].path, "press.csv");
}

TEST(SceneJson, ASeedOrButtonThatIsNoWholeNumberOfItsRangeIsRefusedByName) {
  scene::Scene scene = sample_setup(1);
  scene.noise.seed = 77;
  const std::string written = scene_to_json(scene);
  const auto with = [&written](const std::string& name, const std::string& value, const std::string& other) {
    const std::string field = '"' + name + "\": ";
    return std::regex_replace(written, std::regex(field + value), field + other);
  };
  for (const std::string number : {"1.5", "1.83648e+20", "18446744073709551616", "-1", "\"7\"", "[7]"}) {
    for (const std::string seed : {"77", "18364758544493064720"}) {
      EXPECT_THAT(refusal(with("seed", seed, number)),
                  AllOf(HasSubstr("seed = "), HasSubstr("from 0 to 18446744073709551615")))
          << seed << " replaced by " << number;
    }
  }
  for (const std::string number : {"32", "40", "4294967296", "-1", "2.5"}) {
    EXPECT_EQ(refusal(with("clutch_button", "3", number)),
              "scene: devices[0].clutch_button = " + number + ": must be a whole number from 0 to 31");
  }
}

TEST(SceneJson, ANumberOutsideTheRangeOfItsKeyIsRefusedByName) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& words) {
    EXPECT_THAT(refusal(changed(from, to)), HasSubstr(words));
  };
  expect(R"("rate_Hz": 1000.0)", R"("rate_Hz": 1e300)", "scene: rate_Hz = 1e+300: must be a number from 100");
  expect(R"("workspace_scale": 2.5)", R"("workspace_scale": 0)", "workspace_scale = 0: must be a number > 0");
  expect(R"("force_scale": 1.0)", R"("force_scale": 1.1)",
         "force_scale = 1.1: must be a number > 0 and <= 1");
  expect(R"("max_force_N": 19.0)", R"("max_force_N": 51)",
         "safety.max_force_N = 51: must be a number from 0");
  expect(R"("tip_radius_m": 0.3)", R"("tip_radius_m": -0.3)", "tools[0].tip_radius_m = -0.3");
  expect("0.5000000000000001", "0.6", "organ.pose.rotation_wxyz = an array: must be a unit quaternion");
  expect(R"("visible": true)", R"("visible": 1)", "organ.inclusions[0].visible = 1: must be true or false");
}

TEST(SceneJson, MoreHandsThanASceneMayHaveAreRefused) {
  EXPECT_EQ(refusal(scene_to_json(sample_setup(kMaxHands))), "no refusal");
  EXPECT_EQ(refusal(scene_to_json(sample_setup(kMaxHands + 1))),
            "scene: tools: has 5 elements, must have at most 4");
}

TEST(SceneJson, ASceneNestedSoDeepThatACopyWouldTakeTheStackIsRefused) {
  const std::string deep = std::string(300'000, '[') + std::string(300'000, ']');
  EXPECT_THAT(refusal(changed(R"("soft")", deep)), HasSubstr("is nested deeper than 64 levels"));
  EXPECT_THAT(refusal(deep), AllOf(StartsWith("scene: "), HasSubstr("byte 65 of 600000")));
}

TEST(SceneJson, AValueOfAnotherTypeIsNamedWithItsFieldInPlainWords) {
  EXPECT_EQ(refusal(changed(R"("name": "soft")", R"("name": 7)")), "scene: tissue.name = 7: must be a text");
  EXPECT_EQ(refusal("[]"), "scene: it = an array: must be an object");
}

TEST(SceneJson, TheLargestSeedIsReadBack) {
  scene::Scene scene = sample_setup(1);
  scene.seed = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(scene_from_json(scene_to_json(scene)).seed, scene.seed);
}

TEST(SceneJson, ARefusalIsOneLineWhateverWordIsRefused) {
  EXPECT_THAT(refusal(changed(R"("law": "smooth")", R"("law": "smo\noth")")),
              AllOf(HasSubstr("smo oth"), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace palpate::record
