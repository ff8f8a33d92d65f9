#include "app/window/replay_thread.h"

#include <algorithm>
#include <cmath>
#include <exception>

namespace palpate::app {
namespace {

constexpr std::uint64_t kTicksAtOnce = 1000;  // some milliseconds, then it reads the requested tick again

/// Fills the columns up to `column` with the last one, because a short run has fewer ticks than columns.
void last_until(std::vector<PlotColumn>& depth, std::size_t column, double column_width) {
  while (!depth.empty() && depth.size() < column) {
    depth.push_back(
        {static_cast<double>(depth.size()) * column_width, depth.back().least, depth.back().most});
  }
}

HandOverview overview_of_hand(RecordedView& seen, std::uint32_t hand, double column_width) {
  HandOverview all;
  all.deepest = seen.frames().deepest(hand);
  std::uint32_t fault = 0;
  bool contact = false;
  for (std::uint64_t tick = 0; tick < seen.ticks(); ++tick) {
    const haptics::TickRow& row = seen.row(tick, hand);
    const double depth_mm = 1e3 * row.depth;
    all.deepest_mm = std::max(all.deepest_mm, depth_mm);
    const std::size_t column = static_cast<std::size_t>(tick * Overview::kColumns / seen.ticks());
    last_until(all.depth, column, column_width);
    if (all.depth.size() == column)
      all.depth.push_back({static_cast<double>(column) * column_width, depth_mm, depth_mm});
    all.depth.back().least = std::min(all.depth.back().least, depth_mm);
    all.depth.back().most = std::max(all.depth.back().most, depth_mm);
    if (row.phase != 0 && !contact) all.contacts.push_back({tick, tick});
    contact = row.phase != 0;
    if (contact) all.contacts.back().last = tick;
    if (row.fault != 0 && row.fault != fault) all.faults.push_back(tick);
    fault = row.fault;
  }
  last_until(all.depth, Overview::kColumns, column_width);
  return all;
}

}  // namespace

ReplayThread::ReplayThread(record::RecordingFrames& frames) : frames_(frames), thread_([this] { work(); }) {}

ReplayThread::~ReplayThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  news_.notify_one();
  thread_.join();
}

void ReplayThread::want(std::uint64_t tick) {
  {
    const std::lock_guard lock(mutex_);
    if (tick == wanted_) return;
    wanted_ = tick;
    failure_.clear();
  }
  news_.notify_one();
}

bool ReplayThread::take(haptics::Snapshot& snapshot) {
  const std::lock_guard lock(mutex_);
  if (taken_) return false;
  snapshot = newest_;
  taken_ = true;
  return true;
}

bool ReplayThread::there() {
  const std::lock_guard lock(mutex_);
  return is_there();
}

std::string ReplayThread::failure() {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void ReplayThread::work() {
  while (true) {
    std::uint64_t tick = 0;
    {
      std::unique_lock lock(mutex_);
      news_.wait(lock, [this] { return ending_ || !is_there(); });
      if (ending_) return;
      tick = wanted_;
    }
    try {
      go_to(tick);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      if (tick == wanted_) failure_ = error.what();
    }
  }
}

/// Replays the next ticks towards `tick`, and publishes the snapshot when it is reached.
void ReplayThread::go_to(std::uint64_t tick) {
  if (!frames_.approach(tick, kTicksAtOnce)) return;
  const haptics::Snapshot snapshot = frames_.at(tick);
  const std::lock_guard lock(mutex_);
  newest_ = snapshot;
  reached_ = tick;
  reached_any_ = true;
  taken_ = false;
}

void Playback::move_to(double place) { place_ = std::clamp(place, 0.0, last_); }

void Playback::toggle() {
  playing_ = !playing_;
  if (playing_ && place_ >= last_) place_ = 0.0;
}

void Playback::advance(double seconds) {
  if (!playing_) return;
  move_to(place_ + seconds * kSpeeds[speed_] * rate_Hz_);
  if (place_ >= last_) playing_ = false;
}

void Playback::go_to(std::uint64_t tick) { move_to(static_cast<double>(std::min(tick, last()))); }

void Playback::step_ticks(std::int64_t ticks) {
  playing_ = false;
  move_to(std::floor(place_) + static_cast<double>(ticks));
}

void Playback::step_pictures(std::int64_t pictures) {
  const double apart = std::max(1.0, std::round(rate_Hz_ * kSpeeds[speed_] / kPicturesASecond));
  step_ticks(pictures * static_cast<std::int64_t>(apart));
}

void Playback::skip(double seconds) { move_to(std::floor(place_) + std::round(seconds * rate_Hz_)); }

void Playback::choose_speed(std::size_t which) { speed_ = std::min(which, kSpeeds.size() - 1); }

void Playback::change_speed(int by) {
  const auto most = static_cast<std::int64_t>(kSpeeds.size()) - 1;
  speed_ =
      static_cast<std::size_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(speed_) + by, 0, most));
}

Overview overview_of(RecordedView& seen) {
  Overview all;
  all.column_width = seen.duration_s() / static_cast<double>(Overview::kColumns);
  for (std::uint32_t hand = 0; hand < seen.hands(); ++hand) {
    all.hands.push_back(overview_of_hand(seen, hand, all.column_width));
  }
  for (const haptics::ParameterUpdate& change : seen.recording().changes) all.changes.push_back(change.tick);
  return all;
}

std::optional<std::uint64_t> next_fault(const HandOverview& hand, std::uint64_t after) {
  if (hand.faults.empty()) return std::nullopt;
  const auto next = std::upper_bound(hand.faults.begin(), hand.faults.end(), after);
  return next == hand.faults.end() ? hand.faults.front() : *next;
}

ActiveParameters active_parameters(const record::Recording& recording, std::uint64_t tick) {
  const haptics::ParameterUpdate* last = nullptr;
  for (const haptics::ParameterUpdate& change : recording.changes) {
    if (change.tick <= tick) last = &change;
  }
  const noise::NoiseSettings& noise = recording.scene.noise;
  if (last == nullptr) return {recording.scene.tissue, {noise.enabled, noise.gain, noise.threshold}};
  return {haptics::tissue_of(*last), last->noise};
}

}  // namespace palpate::app
