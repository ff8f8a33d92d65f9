#include "app/window/live_run.h"

#include <utility>

namespace palpate::app {

LiveRun::LiveRun(Session& session, std::filesystem::path recording, haptics::LoopThread thread,
                 net::IgtlServer* igtl)
    : session_(session), recording_(std::move(recording)), loop_thread_(thread), igtl_(igtl) {}

LiveRun::LiveRun(std::unique_ptr<Session> session, std::filesystem::path recording,
                 haptics::LoopThread thread, net::IgtlServer* igtl)
    : LiveRun(*session, std::move(recording), thread, igtl) {
  owned_ = std::move(session);
}

void LiveRun::start() {
  run_ = play_in_background(
      session_,
      {.run = {recording_, false, loop_thread_}, .observers = {&snapshots_, &rows_}, .igtl = igtl_});
}

void LiveRun::stop() {
  session_.control().stop();
  if (run_ != nullptr) run_->wait();
}

}  // namespace palpate::app
