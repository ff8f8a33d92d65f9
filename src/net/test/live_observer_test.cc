#include "net/live_observer.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/haptics/gate.h"
#include "net/live_messages.h"

namespace palpate::net {
namespace {

haptics::TickRow row_of(std::uint64_t tick, std::uint32_t hand,
                        haptics::Fault fault = haptics::Fault::kNone) {
  haptics::TickRow row;
  row.tick = tick;
  row.time = 1e-3 * static_cast<double>(tick);
  row.hand = hand;
  row.fault = static_cast<std::uint32_t>(fault);
  row.force = {0.0, 0.0, 1.5};
  row.depth = 4e-3;
  return row;
}

TEST(LiveObserver, ATickIsSeenWhenAllItsHandsAreThere) {
  LiveObserver observer(2, 1000.0);
  EXPECT_EQ(observer.newest(), nullptr);
  observer.on_row(row_of(0, 0));
  EXPECT_EQ(observer.newest(), nullptr) << "the second hand's row is missing";
  observer.on_row(row_of(0, 1));
  ASSERT_NE(observer.newest(), nullptr);
  EXPECT_EQ(observer.newest()->hands, 2U);
  observer.on_row(row_of(1, 0));
  EXPECT_EQ(observer.newest()->rows[0].tick, 0U) << "never half of one tick and half of another";
  observer.on_row(row_of(1, 1));
  EXPECT_EQ(observer.newest()->rows[0].tick, 1U);
  EXPECT_EQ(observer.newest()->rows[1].tick, 1U);
}

TEST(LiveObserver, TheNewestTickKnowsTheChangeInForce) {
  LiveObserver observer(1, 1000.0);
  haptics::ParameterUpdate change;
  change.number = 3;
  observer.on_row(row_of(0, 0));
  EXPECT_EQ(observer.newest()->change, 0U);
  observer.on_update(change);
  observer.on_row(row_of(1, 0));
  EXPECT_EQ(observer.newest()->change, 3U);
}

TEST(LiveObserver, ATickThatBeganAPeriodLateIsCountedOnceForAllItsHands) {
  LiveObserver observer(2, 500.0);
  std::uint64_t tick = 0;
  for (const std::int64_t late_ns : {0, 1'999'999, 2'000'000, 100, 7'000'000}) {
    for (std::uint32_t hand = 0; hand < 2; ++hand) {
      haptics::TickRow row = row_of(tick, hand);
      row.late_ns = late_ns;
      observer.on_row(row);
    }
    ++tick;
  }
  EXPECT_EQ(observer.newest()->missed, 2U);
  LiveState state;
  state.tick = observer.newest();
  EXPECT_EQ(state_json(state)["missed_deadlines"], 2);
  EXPECT_TRUE(state_json(state)["ticks_per_s"].is_null());
  state.rate_Hz = 499.5;
  EXPECT_EQ(state_json(state)["ticks_per_s"], 499.5);
}

TEST(LiveObserver, EveryTurnOfAFaultIsKeptInItsOrder) {
  LiveObserver observer(2, 1000.0);
  observer.on_row(row_of(0, 0));
  observer.on_row(row_of(0, 1, haptics::Fault::kStale));
  observer.on_row(row_of(1, 0));
  observer.on_row(row_of(1, 1, haptics::Fault::kStale));
  observer.on_row(row_of(2, 0));
  observer.on_row(row_of(2, 1));
  const auto latched = observer.take_fault();
  ASSERT_TRUE(latched);
  EXPECT_EQ(latched->tick, 0U);
  EXPECT_EQ(latched->hand, 1U);
  EXPECT_EQ(latched->fault, haptics::Fault::kStale);
  const auto reset = observer.take_fault();
  ASSERT_TRUE(reset);
  EXPECT_EQ(reset->tick, 2U);
  EXPECT_EQ(reset->fault, haptics::Fault::kNone);
  EXPECT_FALSE(observer.take_fault());
}

TEST(LiveMessages, AStateSaysWhatTheRowsDo) {
  LiveObserver observer(1, 1000.0);
  haptics::TickRow row = row_of(1500, 0, haptics::Fault::kDevice);
  row.phase = 1;
  row.status = contact::kJump | haptics::kForceClamped;
  observer.on_row(row);
  LiveState state;
  state.run = 2;
  state.organ_W.position = {0.0, 0.0, 0.25};
  state.tick = observer.newest();
  const nlohmann::ordered_json json = state_json(state);
  EXPECT_EQ(json["run"], 2);
  EXPECT_EQ(json["tick"], 1500);
  EXPECT_EQ(json["time_s"], 1.5);
  EXPECT_EQ(json["organ_m"][2], 0.25);
  const auto& hand = json["hands"].at(0);
  EXPECT_EQ(hand["phase"], "press");
  EXPECT_EQ(hand["depth_m"], 4e-3);
  EXPECT_EQ(hand["force_N"][2], 1.5);
  EXPECT_EQ(hand["fault"], "device");
  EXPECT_EQ(hand["status"], nlohmann::ordered_json({"jump", "force-clamped"}));
}

TEST(LiveMessages, AnErrorNamesItsCodeItsFieldAndItsMessage) {
  const auto error =
      nlohmann::json::parse(error_text({"stream", "7"}, LiveError("field", "rate_Hz: missing", "rate_Hz")));
  EXPECT_EQ(error["error"]["code"], "field");
  EXPECT_EQ(error["error"]["field"], "rate_Hz");
  EXPECT_EQ(error["error"]["words"], "rate_Hz: missing");
  EXPECT_EQ(error["answer"], "stream");
  EXPECT_EQ(error["id"], 7);
  const auto value =
      nlohmann::json::parse(error_text({"set_tissue", ""}, ParameterError("beta", -1.0, "finite and > 0")));
  EXPECT_EQ(value["error"]["code"], "refused");
  EXPECT_EQ(value["error"]["field"], "beta");
  EXPECT_FALSE(value.contains("id"));
}

}  // namespace
}  // namespace palpate::net
