#include "view/report/analysis.h"

#include <gtest/gtest.h>

#include "core/haptics/gate.h"
#include "palpate/error.h"
#include "view/report/test/synthetic_recording.h"

namespace palpate::report {
namespace {

using test::SyntheticRecording;

TEST(Analysis, FindsTheMomentsOfAPress) {
  const record::Recording recording = SyntheticRecording::make();
  const HandAnalysis hand = analyse(recording).hands.at(0);
  ASSERT_TRUE(hand.key_ticks.contact);
  // The path goes 22 mm in 1.5 s and meets the surface after 10 mm, at 0.6818 s: the first tick below it is
  // 682.
  EXPECT_EQ(hand.rows[hand.key_ticks.touch].tick, 682U);
  EXPECT_EQ(hand.rows[hand.key_ticks.rest].tick, 341U);
  EXPECT_EQ(hand.rows[hand.key_ticks.deepest].tick, 1500U);
  EXPECT_EQ(hand.rows[hand.key_ticks.after].tick, 3999U);
  EXPECT_DOUBLE_EQ(hand.peak_depth, SyntheticRecording::kDeepest);
}

TEST(Analysis, WithoutContactItTakesTheNearestTick) {
  const record::Recording recording = SyntheticRecording::make(true, 500);
  const HandAnalysis hand = analyse(recording).hands.at(0);
  EXPECT_FALSE(hand.key_ticks.contact);
  EXPECT_EQ(hand.key_ticks.touch, 499U);
  EXPECT_EQ(hand.key_ticks.deepest, 499U);
  EXPECT_EQ(hand.peak_depth, 0.0);
}

TEST(Analysis, AForceOnTheLawDepartsByNothing) {
  const record::Recording recording = SyntheticRecording::make();
  const HandAnalysis hand = analyse(recording).hands.at(0);
  EXPECT_GT(hand.law.rows, 2100U);
  EXPECT_LT(hand.law.p95, 1e-12);
}

TEST(Analysis, AForceOnALawThatRelaxesAndIsChangedWhileItRanDepartsByNothing) {
  record::Recording recording = SyntheticRecording::make();
  model::TissueParameters& tissue = recording.scene.tissue;
  tissue.law = model::LawKind::kSmooth;
  tissue.relaxation = {{0.4, 0.3}};
  model::TissueParameters stiffer = tissue;
  stiffer.k1 *= 2.0;
  recording.changes.push_back(haptics::parameter_update(stiffer, {}, haptics::kTissueChanged));
  recording.changes.back().tick = 1700;  // during the hold
  const model::SmoothSpringLaw law(tissue, model::Direction::kPress, 1e-3);
  // dq/dt = dF_e/dt - q / 0.3 s, by Euler's method; twice the stiffness gives twice the elastic force.
  double kept = 0.0;
  double before = 0.0;
  for (haptics::TickRow& row : recording.rows) {
    const double elastic = (row.tick < 1700 ? 1.0 : 2.0) * law.force_at(row.depth).force;
    kept += elastic - before - 0.5e-3 / 0.3 * (2.0 * kept + elastic - before);
    before = elastic;
    if (row.phase == 0) kept = 0.0;
    row.tissue_force = row.phase == 0 ? 0.0 : std::max(0.0, 0.6 * elastic + 0.4 * kept);
  }
  const HandAnalysis hand = analyse(recording).hands.at(0);
  EXPECT_GT(hand.law.peak, 1.0);
  EXPECT_LT(hand.law.median, 1e-3 * hand.law.peak);
  recording.changes.clear();
  EXPECT_GT(analyse(recording).hands.at(0).law.p95, 0.1 * hand.law.peak) << "the change is what was followed";
}

TEST(Analysis, NoiseThatIsChangedCountsUpToThere) {
  record::Recording recording = SyntheticRecording::make();
  recording.changes.push_back(haptics::parameter_update(recording.scene.tissue, {}, haptics::kNoiseChanged));
  recording.changes.back().tick = 1000;
  EXPECT_EQ(analyse(recording).hands.at(0).unit_noise.size(), 1000U);
}

TEST(Analysis, AForceFiveMillinewtonsOverTheLawDepartsByThat) {
  record::Recording recording = SyntheticRecording::make();
  for (haptics::TickRow& row : recording.rows) row.tissue_force += 5e-3;
  const HandAnalysis hand = analyse(recording).hands.at(0);
  EXPECT_NEAR(hand.law.median, 5e-3, 1e-12);
  EXPECT_NEAR(hand.law.p95, 5e-3, 1e-12);
  EXPECT_NEAR(hand.peak_tissue_force - hand.law.peak, 5e-3, 1e-12);
}

TEST(Analysis, FrictionIsLeftOutOfTheNormalForce) {
  haptics::TickRow row;
  row.tissue_force = 5.0;
  row.friction = 3.0;
  EXPECT_DOUBLE_EQ(normal_force(row), 4.0);
}

TEST(Analysis, NoiseIsDividedByTheSigmaOfItsDistance) {
  const record::Recording recording = SyntheticRecording::make();
  const HandAnalysis hand = analyse(recording).hands.at(0);
  ASSERT_EQ(hand.unit_noise.size(), 4000U);
  EXPECT_DOUBLE_EQ(hand.contact_sigma, 10e-3);
  for (std::size_t i = 0; i < 4000; i += 97) {
    EXPECT_NEAR(hand.unit_noise[i], noise::unit_sample(1, 0, i), 1e-9) << "tick " << i;
  }
}

TEST(Analysis, HeldNoiseSamplesCountOnce) {
  record::Recording recording = SyntheticRecording::make();
  recording.scene.noise.rate_Hz = 250.0;
  EXPECT_EQ(analyse(recording).hands.at(0).unit_noise.size(), 1000U);
}

TEST(Analysis, NoNoiseLeavesNoSamples) {
  const record::Recording recording = SyntheticRecording::make(false);
  EXPECT_TRUE(analyse(recording).hands.at(0).unit_noise.empty());
}

TEST(Analysis, MissedDeadlinesOfACutOffRecordingAreCountedFromTheRows) {
  record::Recording recording = SyntheticRecording::make();
  EXPECT_EQ(analyse(recording).missed, 3U);  // the loop's own count
  recording.facts.complete = false;
  recording.rows[5].late_ns = 1'000'000;
  recording.rows[9].late_ns = 999'999;
  EXPECT_EQ(analyse(recording).missed, 1U);
}

TEST(Analysis, HandsAreTakenApart) {
  record::Recording recording = SyntheticRecording::make();
  haptics::TickRow other = recording.rows[0];
  other.hand = 1;
  recording.rows.insert(recording.rows.begin() + 1, other);
  const Analysis analysis = analyse(recording);
  ASSERT_EQ(analysis.hands.size(), 2U);
  EXPECT_EQ(analysis.hands[0].rows.size(), 4000U);
  EXPECT_EQ(analysis.hands[1].rows.size(), 1U);
  EXPECT_EQ(analysis.ticks, 4000U);
}

TEST(Analysis, ThePullHasItsOwnDirection) {
  record::Recording recording = SyntheticRecording::make();
  recording.scene.task = scene::Task::kPull;
  EXPECT_EQ(analyse(recording).direction, model::Direction::kPull);
  EXPECT_EQ(analyse(recording).hands.at(0).law.rows, 0U);  // nothing was pulled
}

TEST(Analysis, RefusesARecordingWithoutTicks) {
  EXPECT_THROW(static_cast<void>(analyse(record::Recording{})), InputError);
}

TEST(Analysis, SaysStatusBitsAndFaultsInWords) {
  std::vector<haptics::TickRow> rows(10);
  rows[2].status = haptics::kForceClamped | contact::kGripReleased;
  rows[3].status = haptics::kForceClamped;
  rows[4].fault = 1;
  const std::vector<std::string> words = status_text(rows);
  ASSERT_EQ(words.size(), 3U);
  EXPECT_EQ(words[0], "the grip let go, past its limit (1 ticks)");
  EXPECT_EQ(words[1], "the force was clamped at max_force_N (2 ticks)");
  EXPECT_EQ(words[2], "a fault was latched (1 ticks)");
}

TEST(Analysis, SaysOfEachFaultWhenItWasLatchedWhyAndWhenItWasReset) {
  std::vector<haptics::TickRow> rows(10);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].tick = i;
    rows[i].time = static_cast<double>(i) * 1e-3;
  }
  for (const std::size_t i : {3U, 4U}) rows[i].fault = static_cast<std::uint32_t>(haptics::Fault::kStalled);
  for (const std::size_t i : {7U, 8U, 9U}) rows[i].fault = static_cast<std::uint32_t>(haptics::Fault::kStale);
  rows[9].events = haptics::kResetFault;  // and latched again at once
  const std::vector<std::string> words = faults_text(rows);
  ASSERT_EQ(words.size(), 3U);
  EXPECT_EQ(words[0],
            "fault at tick 3 (0.003 s): the loop stood still for 20 ms (stalled-loop); zero force from there "
            "on, until it was reset at tick 5 (0.005 s)");
  EXPECT_EQ(
      words[1],
      "fault at tick 7 (0.007 s): the device gave no new sample for 5 ms (stale-sample); zero force from "
      "there on, until it was reset at tick 9 (0.009 s)");
  EXPECT_EQ(
      words[2],
      "fault at tick 9 (0.009 s): the device gave no new sample for 5 ms (stale-sample); zero force from "
      "there on");
  EXPECT_TRUE(faults_text(std::vector<haptics::TickRow>(3)).empty());
}

TEST(Analysis, TakesTheLoopsOwnCountsOfTimesWhereThereAreSomeAndElseTheRows) {
  record::Recording recording = SyntheticRecording::make(false, 100);
  const Analysis from_rows = analyse(recording);
  EXPECT_EQ(from_rows.tick_time.figures.count, 100U);
  std::uint64_t counted = 0;
  for (const haptics::Histogram::Bucket& bucket : from_rows.tick_time.counts) counted += bucket.count;
  EXPECT_EQ(counted, 100U);
  recording.facts.tick_histogram = {{1000, 3}, {2000, 1}};
  recording.facts.tick_time = {1000, 1999, 1999, 1999};
  const Analysis from_loop = analyse(recording);
  EXPECT_EQ(from_loop.tick_time.figures.count, 4U);
  EXPECT_EQ(from_loop.tick_time.figures.max, 1999);
  EXPECT_EQ(from_loop.tick_time.counts.size(), 2U);
  EXPECT_EQ(from_loop.lateness.figures.count, 100U);
}

}  // namespace
}  // namespace palpate::report
