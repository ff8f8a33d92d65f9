#include "app/window/live_run.h"

#include <exception>
#include <utility>

#include "palpate/record/assemble.h"

namespace palpate::app {

LiveRun::LiveRun(Session& session, std::filesystem::path recording, haptics::LoopThread thread,
                 net::IgtlServer* igtl)
    : session_(session),
      recording_(std::move(recording)),
      loop_thread_(thread),
      igtl_(igtl),
      changes_(record::live_changes(session_.setup, session_.world)),
      may_pause_(app::may_pause(session_)) {}

LiveRun::LiveRun(std::unique_ptr<Session> session, std::filesystem::path recording,
                 haptics::LoopThread thread, net::IgtlServer* igtl)
    : LiveRun(*session, std::move(recording), thread, igtl) {
  owned_ = std::move(session);
}

LiveRun::~LiveRun() { stop(); }

void LiveRun::start() {
  thread_ = std::thread([this] {
    try {
      account_ =
          play(session_,
               {recording_, false, loop_thread_, changes_.get(), &snapshots_, &rows_, igtl_, &pause_}, stop_);
    } catch (const std::exception& error) {
      failure_ = error.what();
    }
    ended_.store(true, std::memory_order_release);
  });
}

void LiveRun::stop() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

}  // namespace palpate::app
