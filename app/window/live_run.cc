#include "app/window/live_run.h"

#include <exception>
#include <utility>

#include "palpate/record/assemble.h"

namespace palpate::app {

LiveRun::LiveRun(Session& session, std::filesystem::path recording, std::optional<int> core,
                 net::IgtlServer* igtl)
    : session_(session), recording_(std::move(recording)) {
  start(core, igtl);
}

LiveRun::LiveRun(std::unique_ptr<Session> session, std::filesystem::path recording, std::optional<int> core,
                 net::IgtlServer* igtl)
    : owned_(std::move(session)), session_(*owned_), recording_(std::move(recording)) {
  start(core, igtl);
}

LiveRun::~LiveRun() { stop(); }

void LiveRun::start(std::optional<int> core, net::IgtlServer* igtl) {
  may_pause_ = app::may_pause(session_);
  changes_ = record::live_changes(session_.setup, session_.world);
  thread_ = std::thread([this, core, igtl] {
    try {
      account_ = play(session_, {recording_, false, core, changes_.get(), &snapshots_, &rows_, igtl, &pause_},
                      stop_);
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
