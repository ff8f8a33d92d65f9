#include "io/record/flight_recorder.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "io/record/test/sample_recording.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

haptics::TickRow row_of(std::uint64_t tick, std::uint32_t hand,
                        haptics::Fault fault = haptics::Fault::kNone) {
  haptics::TickRow row = sample_row(tick, hand);
  row.tick = tick;
  row.hand = hand;
  row.fault = static_cast<std::uint32_t>(fault);
  return row;
}

scene::Scene two_hands() {
  scene::Scene scene = sample_setup(2);
  scene.rate_Hz = 1000.0;
  return scene;
}

TEST(FlightRecorder, KeepsTwoSecondsBeforeTheFirstFaultAndAQuarterFromItOn) {
  const scene::Scene scene = two_hands();
  FlightRecorder recorder(scene);
  for (std::uint64_t tick = 0; tick < 20'000; ++tick) {
    for (std::uint32_t hand = 0; hand < 2; ++hand) {
      const bool faulty = hand == 1 && tick >= 9000;
      recorder.on_row(row_of(tick, hand, faulty ? haptics::Fault::kStale : haptics::Fault::kNone));
    }
  }
  EXPECT_TRUE(recorder.fault_met());
  const auto rows = recorder.rows();
  ASSERT_FALSE(rows.empty());
  EXPECT_LE(rows.front().tick, 7001U);
  EXPECT_GE(rows.back().tick, 9248U);
  EXPECT_LE(rows.back().tick, 9250U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].hand, i % 2) << "whole ticks";
    ASSERT_EQ(rows[i].tick, rows.front().tick + i / 2) << "in order";
  }
}

TEST(FlightRecorder, AShortRunIsKeptWhole) {
  const scene::Scene scene = two_hands();
  FlightRecorder recorder(scene);
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    recorder.on_row(row_of(tick, 0));
    recorder.on_row(row_of(tick, 1));
  }
  EXPECT_FALSE(recorder.fault_met());
  EXPECT_EQ(recorder.rows().size(), 20U);
}

TEST(FlightRecorder, WritesARecordingThatOpens) {
  const TemporaryFolder folder;
  const scene::Scene scene = two_hands();
  FlightRecorder recorder(scene);
  recorder.on_start(kStarted);
  for (std::uint64_t tick = 0; tick < 5000; ++tick) {
    recorder.on_row(row_of(tick, 0));
    recorder.on_row(row_of(tick, 1, tick < 4000 ? haptics::Fault::kNone : haptics::Fault::kForceOff));
  }
  recorder.write(folder / "fault.h5", {});
  const Recording recording = read_recording(folder / "fault.h5");
  EXPECT_EQ(recording.rows.size(), recorder.rows().size());
  EXPECT_TRUE(same_bits(recording.rows.front(), recorder.rows().front()));
  EXPECT_TRUE(same_bits(recording.rows.back(), recorder.rows().back()));
  EXPECT_EQ(recording.facts.started_unix_ns, kStarted);
}

TEST(KeepFlight, PutsWhatLedToAFaultIntoTheUsersStateFolder) {
  const TemporaryFolder folder;
  const char* const before = std::getenv("XDG_STATE_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  const scene::Scene scene = two_hands();
  FlightRecorder recorder(scene);
  recorder.on_row(row_of(0, 0, haptics::Fault::kDevice));
  recorder.on_row(row_of(0, 1));
  const std::filesystem::path file = write_flight_recording(recorder, {});
  if (before == nullptr) {
    unsetenv("XDG_STATE_HOME");
  } else {
    setenv("XDG_STATE_HOME", kept.c_str(), 1);
  }
  EXPECT_EQ(file.parent_path(), folder / "palpate" / "faults");
  EXPECT_EQ(read_recording(file).rows.size(), 2U);
}

TEST(FlightRecorder, AFolderThatIsNotThereIsNamed) {
  const scene::Scene scene = two_hands();
  const FlightRecorder recorder(scene);
  EXPECT_THROW(recorder.write("/none/fault.h5", {}), InputError);
}

}  // namespace
}  // namespace palpate::record
