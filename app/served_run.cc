#include "app/served_run.h"

#include <utility>

namespace palpate::app {

ServedRun::ServedRun(std::unique_ptr<Session> session, std::uint64_t number, std::filesystem::path recording,
                     haptics::LoopThread thread)
    : session_(std::move(session)),
      number_(number),
      recording_(std::move(recording)),
      tap_(session_->hands()),
      run_(play_in_background(*session_,
                              {.run = {recording_, false, thread}, .observers = {&tap_, &snapshots_}})) {}

const haptics::Snapshot* ServedRun::snapshot() noexcept {
  seen_ = snapshots_.cell().refresh() || seen_;
  return seen_ ? &snapshots_.cell().value() : nullptr;
}

void ServedRun::release() {
  run_->wait();
  session_->close_devices();
}

}  // namespace palpate::app
