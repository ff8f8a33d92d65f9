#include "app/window/replay_thread.h"

#include <exception>

namespace palpate::app {
namespace {

constexpr std::uint64_t kTicksAtOnce = 1000;  // some milliseconds, then it reads the requested tick again

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

}  // namespace palpate::app
