#include "app/next_session.h"

#include <exception>
#include <utility>

namespace palpate::app {

template <typename Work>
void NextSession::work(State from_then_on, Work&& doing) {
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this, from_then_on, doing = std::forward<Work>(doing)] {
    try {
      doing();
      state_.store(from_then_on, std::memory_order_release);
    } catch (const std::exception& error) {
      failure_ = error.what();
      state_.store(State::kFailed, std::memory_order_release);
    }
  });
}

NextSession::NextSession(scene::Request request, Kept kept, std::filesystem::path recording, Check check)
    : request_(std::move(request)),
      kept_(std::move(kept)),
      recording_(std::move(recording)),
      check_(std::move(check)) {
  work(State::kRead, [this] {
    scene::Setup setup = scene::load(request_);
    if (kept_.tissue) setup.tissue = *kept_.tissue;
    if (kept_.noise) {
      const double rate_Hz = setup.noise.rate_Hz;
      setup.noise = *kept_.noise;
      setup.noise.rate_Hz = rate_Hz;
    }
    if (check_) check_(setup);
    if (!recording_.empty()) require_writable_file(recording_, "recording");
    setup_ = std::move(setup);
  });
}

NextSession::~NextSession() {
  if (thread_.joinable()) thread_.join();
}

void NextSession::prepare_now(std::optional<double> duration_s, bool no_cache) {
  state_.store(State::kPreparing, std::memory_order_release);
  work(State::kReady, [this, duration_s, no_cache] {
    session_ = prepare(std::move(*setup_), duration_s, no_cache, &broken_off_);
  });
}

}  // namespace palpate::app
