#include "app/served_run.h"

#include <exception>
#include <utility>

#include "palpate/record/assemble.h"

namespace palpate::app {

ServedRun::ServedRun(std::unique_ptr<Session> session, std::uint64_t number, std::filesystem::path recording,
                     haptics::LoopThread thread)
    : session_(std::move(session)),
      number_(number),
      recording_(std::move(recording)),
      tap_(session_->devices.size()),
      changes_(record::live_changes(session_->setup, session_->world)) {
  thread_ = std::thread([this, thread] {
    PlayOptions how;
    how.recording = recording_;
    how.thread = thread;
    how.changes = changes_.get();
    how.onlooker = &tap_;
    how.snapshots = &snapshots_;
    try {
      account_ = play(*session_, how, stop_);
    } catch (const std::exception& error) {
      failure_ = error.what();
    }
    ended_.store(true, std::memory_order_release);
  });
}

ServedRun::~ServedRun() {
  stop();
  if (thread_.joinable()) thread_.join();
}

const haptics::Snapshot* ServedRun::snapshot() noexcept {
  seen_ = snapshots_.refresh() || seen_;
  return seen_ ? &snapshots_.value() : nullptr;
}

void ServedRun::release() {
  if (thread_.joinable()) thread_.join();
  session_->devices.clear();
}

}  // namespace palpate::app
