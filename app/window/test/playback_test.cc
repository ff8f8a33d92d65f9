// Playback position, overview and replay of a viewer, without a window.

#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "app/recorded_view.h"
#include "app/session.h"
#include "app/window/replay_thread.h"
#include "app/window/viewer_panels.h"
#include "app/window/viewport.h"

namespace palpate::app {
namespace {

TEST(Playback, GoesOnByTheTimeThatPassesAndItsSpeed) {
  Playback playback(10'000, 1000.0);
  playback.advance(1.0);
  EXPECT_EQ(playback.tick(), 0U) << "it is not playing";
  playback.toggle();
  playback.advance(1.0);
  EXPECT_EQ(playback.tick(), 1000U);
  playback.choose_speed(0);  // a tenth
  for (int frame = 0; frame < 50; ++frame) playback.advance(1.0 / 64.0);
  EXPECT_EQ(playback.tick(), 1078U) << "50/64 s at a tenth are 78 ticks: parts of ticks add up";
  playback.choose_speed(4);  // twice
  playback.advance(2.0);
  EXPECT_EQ(playback.tick(), 5078U);
}

TEST(Playback, StopsAtTheEndAndPlaysFromTheBeginningAgain) {
  Playback playback(500, 1000.0);
  playback.toggle();
  playback.advance(2.0);
  EXPECT_EQ(playback.tick(), 499U);
  EXPECT_FALSE(playback.playing());
  playback.toggle();
  EXPECT_TRUE(playback.playing());
  EXPECT_EQ(playback.tick(), 0U);
}

TEST(Playback, StepsATickOrAPictureAndStaysWithin) {
  Playback playback(500, 1000.0);
  playback.step_ticks(-1);
  EXPECT_EQ(playback.tick(), 0U);
  playback.step_pictures(1);
  EXPECT_EQ(playback.tick(), 33U) << "a thirtieth of a second";
  playback.choose_speed(0);
  playback.step_pictures(1);
  EXPECT_EQ(playback.tick(), 36U) << "at a tenth of the speed pictures are 3.3 ticks apart";
  playback.toggle();
  playback.step_ticks(1);
  EXPECT_FALSE(playback.playing());
  EXPECT_EQ(playback.tick(), 37U);
  playback.skip(1.0);
  EXPECT_EQ(playback.tick(), 499U);
  playback.go_to(12'345);
  EXPECT_EQ(playback.tick(), 499U);
}

TEST(Playback, SpeedsEndAtATenthAndAtTwice) {
  Playback playback(500, 1000.0);
  playback.change_speed(5);
  EXPECT_EQ(Playback::kSpeeds[playback.speed()], 2.0);
  playback.change_speed(-9);
  EXPECT_EQ(Playback::kSpeeds[playback.speed()], 0.1);
}

void record_a_press(const std::filesystem::path& file, double duration_s, double rate_Hz = 1000.0) {
  scene::Overrides request;
  request.organ = "ball";
  request.tissue = "liver";
  request.tools = {"sphere:5"};
  request.rate_Hz = rate_Hz;
  (void)Session(scene::load(request), {.duration_s = duration_s}).run({file, true});
}

TEST(Overview, KnowsContactsDepthAndFaultsAsTheRowsHaveThem) {
  const test::TemporaryFolder folder;
  record_a_press(folder / "a.h5", 3.0);
  RecordedView seen(folder / "a.h5", true);
  const Overview all = overview_of(seen);
  ASSERT_EQ(all.hands.size(), 1U);
  const HandOverview& hand = all.hands[0];
  ASSERT_EQ(hand.contacts.size(), 1U);
  const std::uint64_t first = hand.contacts[0].first;
  EXPECT_EQ(seen.row(first - 1, 0).phase, 0U);
  EXPECT_NE(seen.row(first, 0).phase, 0U);
  EXPECT_EQ(hand.deepest, seen.frames().deepest(0));
  EXPECT_EQ(hand.deepest_mm, 1e3 * seen.row(hand.deepest, 0).depth);
  EXPECT_EQ(hand.depth.size(), Overview::kColumns);
  EXPECT_TRUE(hand.faults.empty());
  EXPECT_EQ(next_fault(hand, 0), std::nullopt);
  EXPECT_EQ(active_parameters(seen.recording(), 0).tissue.name, "liver");
}

TEST(Overview, AShortRunFillsItsTimelineAndNothingComesEarly) {
  const test::TemporaryFolder folder;
  record_a_press(folder / "a.h5", 3.0, 100.0);
  RecordedView seen(folder / "a.h5", true);
  ASSERT_EQ(seen.ticks(), 300U) << "fewer than there are columns";
  const HandOverview hand = overview_of(seen).hands[0];
  ASSERT_GT(hand.deepest_mm, 1.0);
  ASSERT_EQ(hand.depth.size(), Overview::kColumns);
  for (std::size_t column = 0; column < Overview::kColumns; ++column) {
    const std::size_t tick = ((column + 1) * 300 - 1) / Overview::kColumns;  // last tick of the column
    EXPECT_EQ(hand.depth[column].most, 1e3 * seen.row(tick, 0).depth) << column;
  }
}

/// Result of a replay thread for the requested tick.
struct Answer {
  std::optional<std::uint64_t> tick;
  std::string failure;
};

Answer ask(ReplayThread& replay, std::uint64_t tick) {
  replay.want(tick);
  while (!replay.there()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  haptics::Snapshot snapshot;
  const bool news = replay.take(snapshot);
  return {news ? std::optional(snapshot.tick) : std::nullopt, replay.failure()};
}

TEST(ReplayThread, ATickThatCannotBeRunIsSaidAndLeavesTheOthers) {
  const test::TemporaryFolder folder;
  record_a_press(folder / "a.h5", 1.0);
  record::Recording recording = record::read_recording(folder / "a.h5");
  recording.rows[700].events |= haptics::kParameterUpdated;
  record::RecordingFrames frames(recording);
  ReplayThread replay(frames);
  EXPECT_EQ(ask(replay, 600).tick, 600U);
  const Answer bad = ask(replay, 800);
  EXPECT_EQ(bad.tick, std::nullopt);
  EXPECT_THAT(bad.failure, testing::HasSubstr("lacks the change of tissue or noise at tick 700"));
  const Answer good = ask(replay, 650);
  EXPECT_EQ(good.tick, 650U);
  EXPECT_EQ(good.failure, "");
}

TEST(Overview, TheNextFaultComesRoundToTheFirst) {
  HandOverview hand;
  hand.faults = {100, 700};
  EXPECT_EQ(next_fault(hand, 0), 100U);
  EXPECT_EQ(next_fault(hand, 100), 700U);
  EXPECT_EQ(next_fault(hand, 700), 100U);
}

TEST(ViewerLayout, HoldsAtAnyScaleAndGivesWayToThePicture) {
  const ViewerState state;
  const ViewerLayout plain = lay_out(1440.0F, 900.0F, 1.0F, state);
  const ViewerLayout twice = lay_out(2880.0F, 1800.0F, 2.0F, state);
  for (const auto part :
       {&ViewerLayout::picture, &ViewerLayout::left, &ViewerLayout::timeline, &ViewerLayout::plots}) {
    EXPECT_EQ((twice.*part).x, 2.0F * (plain.*part).x);
    EXPECT_EQ((twice.*part).y, 2.0F * (plain.*part).y);
    EXPECT_EQ((twice.*part).width, 2.0F * (plain.*part).width);
    EXPECT_EQ((twice.*part).height, 2.0F * (plain.*part).height);
    EXPECT_GT((plain.*part).width * (plain.*part).height, 0.0F);
  }
  const ViewerLayout tiny = lay_out(200.0F, 100.0F, 1.0F, state);
  EXPECT_EQ(tiny.picture.width, 200.0F);
  EXPECT_EQ(tiny.timeline.height, 0.0F);
  ViewerState hidden;
  hidden.hidden = true;
  EXPECT_EQ(lay_out(1440.0F, 900.0F, 1.0F, hidden).picture.height, 900.0F);
}

TEST(UiScale, IsANumberFromAHalfToFour) {
  EXPECT_EQ(UiScale::asked("1.5"), 1.5F);
  EXPECT_THROW((void)UiScale::asked("9"), InputError);
  EXPECT_THROW((void)UiScale::asked("0.1"), InputError);
  EXPECT_THROW((void)UiScale::asked("large"), InputError);
  setenv("PALPATE_UI_SCALE", "2", 1);
  EXPECT_EQ(UiScale::asked(""), 2.0F);
  EXPECT_EQ(UiScale::asked("1"), 1.0F) << "the flag goes before the environment";
  setenv("PALPATE_UI_SCALE", "5", 1);
  EXPECT_THROW((void)UiScale::asked(""), InputError);
  unsetenv("PALPATE_UI_SCALE");
  EXPECT_EQ(UiScale::asked(""), std::nullopt);
}

}  // namespace
}  // namespace palpate::app
