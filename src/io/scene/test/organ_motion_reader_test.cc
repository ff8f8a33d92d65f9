#include "io/scene/organ_motion_reader.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/scene_file.h"
#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using model::OrganMotionKind;
using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

const double kPi = std::acos(-1.0);
const std::string kScene = "[tool]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"box\"\n";  // four lines

std::vector<model::OrganMotionParameters> motions_of(const std::string& content) {
  const TemporaryFolder folder;
  return read_scene_file(folder.write("s.toml", kScene + content)).organ_motion;
}

std::string motion_error_in(const std::string& content) {
  const TemporaryFolder folder;
  const auto file = folder.write("s.toml", kScene + content);
  return error_of([&] { (void)read_scene_file(file); });
}

TEST(OrganMotionTable, WithoutItTheOrganLiesStill) {
  EXPECT_TRUE(motions_of("").empty());
  EXPECT_TRUE(motions_of("[organ.motion]\nkind = \"none\"\n").empty());
}

TEST(OrganMotionTable, ReadsEveryFieldIntoSi) {
  const auto motions = motions_of(
      "[organ.motion]\nkind = \"heartbeat\"\namplitude_mm = 8\ndirection = [0, 3, 4]\nrotation_deg = -9\n"
      "axis = [2, 0, 0]\nperiod_s = 1.5\nphase = 0.25\n");
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].kind, OrganMotionKind::kHeartbeat);
  EXPECT_DOUBLE_EQ(motions[0].amplitude, 0.008);
  EXPECT_NEAR((motions[0].direction_W - Vec3(0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(motions[0].rotation, -kPi / 20.0);
  EXPECT_EQ(motions[0].axis_W, Vec3(1, 0, 0));
  EXPECT_EQ(motions[0].period, 1.5);
  EXPECT_EQ(motions[0].phase, 0.25);
}

TEST(OrganMotionTable, WhatIsLeftOutIsTheKindsDefault) {
  const auto motions = motions_of("motion = { kind = \"breathing\" }\n");
  const auto preset = model::organ_motion_preset(OrganMotionKind::kBreathing);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].amplitude, preset.amplitude);
  EXPECT_EQ(motions[0].period, preset.period);
  EXPECT_EQ(motions[0].direction_W, preset.direction_W);
  EXPECT_EQ(motions[0].phase, 0.0);
}

TEST(OrganMotionTable, AHeartBeatsAndBreathesAtOnceByAnArrayOfTables) {
  const auto motions =
      motions_of("[[organ.motion]]\nkind = \"heartbeat\"\n[[organ.motion]]\nkind = \"breathing\"\n");
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[0].kind, OrganMotionKind::kHeartbeat);
  EXPECT_EQ(motions[1].kind, OrganMotionKind::kBreathing);
}

TEST(OrganMotionTable, RefusesBadValuesAtTheirLineWithFieldAndValue) {
  const std::string breathing = "[organ.motion]\nkind = \"breathing\"\n";  // lines 5 and 6
  for (const auto& [text, want] : std::vector<std::pair<std::string, std::string>>{
           {"motion = 3\n", ":5: organ.motion = 3: must be a table or an array of tables"},
           {"[organ.motion]\nperiod_s = 4\n",
            ":5: organ.motion.kind: missing, must be breathing, heartbeat or none"},
           {"[organ.motion]\nkind = \"sneezing\"\n",
            ":6: organ.motion.kind = \"sneezing\": must be breathing, heartbeat or none"},
           {"[organ.motion]\nkind = 1\n", ":6: organ.motion.kind = 1: must be a text"},
           {breathing + "amplitude = 8\n",
            ":7: organ.motion.amplitude = 8: unknown key, did you mean amplitude_mm?"},
           {breathing + "amplitude_mm = \"8\"\n",
            ":7: organ.motion.amplitude_mm = \"8\": must be a finite number"},
           {breathing + "amplitude_mm = 101\n",
            ":7: organ.motion.amplitude_mm = 101: must be a number >= 0 and <= 100"},
           {breathing + "amplitude_mm = nan\n", ":7: organ.motion.amplitude_mm = nan: must be a finite"},
           {breathing + "direction = [0, 0, 0]\n",
            "organ.motion.direction = [ 0, 0, 0 ]: must be a direction"},
           {breathing + "direction = 1\n", ":7: organ.motion.direction = 1: must be three numbers"},
           {breathing + "rotation_deg = 46\n",
            ":7: organ.motion.rotation_deg = 46: must be a number >= -45 and <= 45"},
           {breathing + "period_s = 0\n", ":7: organ.motion.period_s = 0: must be a number >= 0.2 and <= 60"},
           {breathing + "phase = 1\n", ":7: organ.motion.phase = 1: must be >= 0 and < 1"},
           {breathing + "period_s = 0.4\namplitude_mm = 100\n",
            ":7: organ.motion.period_s = 0.4: must be so long, or amplitude_mm and rotation_deg so small, "
            "that the organ stays below 1 m/s"}}) {
    EXPECT_THAT(motion_error_in(text), HasSubstr(want)) << text;
  }
}

TEST(OrganMotionTable, TheLimitsThemselvesPass) {
  const auto motions = motions_of(
      "[organ.motion]\nkind = \"breathing\"\namplitude_mm = 100\nrotation_deg = 45\nperiod_s = 60\n");
  EXPECT_EQ(motions.size(), 1U);
}

TEST(OrganMotionTable, RefusesMotionsThatAreTooFastOrTooManyTogether) {
  const std::string fast = "[[organ.motion]]\nkind = \"heartbeat\"\nperiod_s = 0.3\namplitude_mm = 30\n";
  EXPECT_EQ(motions_of(fast).size(), 1U);
  EXPECT_THAT(motion_error_in(fast + fast), HasSubstr(":11: organ.motion.period_s = 0.3: must be so long"));
  std::string many;
  for (int i = 0; i < 5; ++i) many += "[[organ.motion]]\nkind = \"breathing\"\n";
  EXPECT_THAT(motion_error_in(many),
              HasSubstr(":14: organ.motion.kind = \"breathing\": 5 motions of one organ"));
}

TEST(OrganMotionFlag, ReplacesTheMotionsOfTheScene) {
  const TemporaryFolder folder;
  Overrides request;
  request.scene = folder.write("s.toml", kScene + "[organ.motion]\nkind = \"breathing\"\namplitude_mm = 5\n");
  EXPECT_DOUBLE_EQ(load(request).organ_motion.at(0).amplitude, 0.005);
  request.organ_motion = {"none"};
  EXPECT_TRUE(load(request).organ_motion.empty());
  request.organ_motion = {"heartbeat", "breathing"};
  const scene::Scene scene = load(request);
  ASSERT_EQ(scene.organ_motion.size(), 2U);
  EXPECT_EQ(scene.organ_motion[0].kind, OrganMotionKind::kHeartbeat);
  EXPECT_DOUBLE_EQ(scene.organ_motion[1].amplitude, 0.010);
}

TEST(OrganMotionFlag, RefusesOtherWordsAndTooMany) {
  EXPECT_EQ(error_of([] { (void)organ_motions_by_flags(std::vector<std::string>{"running"}); }),
            "--organ-motion = \"running\": must be breathing, heartbeat or none");
  EXPECT_THAT(error_of([] { (void)organ_motions_by_flags(std::vector<std::string>(5, "breathing")); }),
              HasSubstr("--organ-motion: 5 motions of one organ"));
}

}  // namespace
}  // namespace palpate::scene
