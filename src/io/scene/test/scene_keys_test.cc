#include "io/scene/scene_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

Scene loaded(const TemporaryFolder& folder, const std::vector<Setting>& settings) {
  Overrides request;
  request.scene = folder.write("press.toml", "[organ]\nmesh = \"box\"\n[[tool]]\nmesh = \"sphere:3\"\n");
  request.settings = settings;
  return load(request);
}

TEST(SceneKeys, ASettingTakesThePlaceOfTheScenesValue) {
  const TemporaryFolder folder;
  const auto scene = loaded(folder, {{"scene.rate_Hz", "2000"},
                                     {"scene.seed", "7"},
                                     {"noise.enabled", "false"},
                                     {"path.speed", "2"},
                                     {"tool.tip_radius_mm", "4"},
                                     {"tissue.k1_N_per_m", "33"},
                                     {"tissue.rest_length_mm", "15"},
                                     {"tissue.law", "smooth"}});
  EXPECT_EQ(scene.rate_Hz, 2000.0);
  EXPECT_EQ(scene.seed, 7U);
  EXPECT_FALSE(scene.noise.enabled);
  EXPECT_EQ(scene.devices.at(0).path_speed, 2.0);
  EXPECT_EQ(scene.tools.at(0).tip_radius, 4e-3);
  EXPECT_EQ(scene.tissue.k1, 33.0);
  EXPECT_DOUBLE_EQ(scene.tissue.rest_length, 15e-3);
  EXPECT_EQ(scene.tissue.law, model::LawKind::kSmooth);
}

TEST(SceneKeys, AValueThatDoesNotSuitTheOthersIsReportedWithItsKey) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] {
                (void)loaded(folder, {{"device.mass_kg", "1"}});
              }),
              HasSubstr("press.toml with --set: device.mass_kg = 1: is only for kind = \"emulated\""));
  EXPECT_THAT(error_of([&] {
                (void)loaded(folder, {{"tissue.min_length_mm", "99"}});
              }),
              HasSubstr("--set tissue.min_length_mm = 99: must be finite, >= 0 and < rest_length_mm"));
  EXPECT_EQ(error_of([&] {
              (void)loaded(folder, {{"tissue.law", "linear"}});
            }),
            "--set tissue.law = \"linear\": must be layered or smooth");
  EXPECT_EQ(error_of([&] {
              (void)loaded(folder, {{"device.mass_kg", "1000"}});
            }),
            "--set device.mass_kg = 1000: must be a number >= 0.001 and <= 100");
}

TEST(SceneKeys, NeedASceneFile) {
  Overrides request;
  request.settings = {{"path.speed", "2"}};
  EXPECT_EQ(error_of([&] { (void)load(request); }), "--set path.speed: needs a scene file");
}

/// A key that no reader knows would be reported as an unknown key.
TEST(SceneKeys, EachIsKnownToTheReadersOfAScene) {
  const TemporaryFolder folder;
  for (const SceneKey& key : scene_keys()) {
    const char* value = key.type == KeyType::kTruth ? "true" : key.type == KeyType::kText ? "x" : "1";
    std::string error;
    try {
      (void)loaded(folder, {{key.path, value}});
    } catch (const InputError& refused) {
      error = refused.what();
    }
    EXPECT_EQ(error.find("unknown key"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace palpate::scene
