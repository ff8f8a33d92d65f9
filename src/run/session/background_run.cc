#include <exception>
#include <utility>

#include "palpate/session.h"

namespace palpate::session {

BackgroundRun::BackgroundRun(haptics::RunControl& control, std::function<RunResult()> run)
    : control_(control), thread_([this, run = std::move(run)] {
        try {
          result_ = run();
        } catch (const std::exception& error) {
          failure_ = error.what();
        } catch (...) {  // of a device that the user has written
          failure_ = "an exception that is none of the standard library's";
        }
        const std::lock_guard lock(mutex_);
        ended_ = true;
        changed_.notify_all();
      }) {}

BackgroundRun::~BackgroundRun() {
  stop();
  wait();
}

void BackgroundRun::wait() {
  const std::lock_guard lock(joining_);
  if (thread_.joinable()) thread_.join();
}

bool BackgroundRun::wait_for(std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, time, [this] { return ended_; });
}

}  // namespace palpate::session
