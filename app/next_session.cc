#include "app/next_session.h"

#include <chrono>
#include <exception>
#include <utility>

#include "run/devices/crash_stop.h"
#include "run/realtime/realtime.h"

namespace palpate::app {

NextSession::State NextSession::state() {
  if (!work_.valid() || work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return state_;
  try {
    work_.get();
    state_ = state_ == State::kReading ? State::kRead : State::kReady;
  } catch (const std::exception& error) {
    failure_ = error.what();
    state_ = State::kFailed;
  } catch (...) {  // of a vendor's library
    failure_ = "an exception that is none of the standard library's";
    state_ = State::kFailed;
  }
  return state_;
}

NextSession::NextSession(scene::Overrides request, KeptParameters kept, std::filesystem::path recording,
                         Check check)
    : request_(std::move(request)),
      kept_(std::move(kept)),
      recording_(std::move(recording)),
      check_(std::move(check)) {
  work_ = std::async(std::launch::async, [this] {
    const devices::SignalStack signal_stack;
    realtime::yield_to_loop();
    scene::Scene scene = scene::load(request_);
    if (kept_.tissue) scene.tissue = *kept_.tissue;
    if (kept_.inclusions) scene.inclusions = *kept_.inclusions;
    if (kept_.noise) {
      const double rate_Hz = scene.noise.rate_Hz;
      scene.noise = *kept_.noise;
      scene.noise.rate_Hz = rate_Hz;
    }
    if (check_) check_(scene);
    if (!recording_.empty()) {
      require_regular_file(recording_, "recording");
      require_no_overwrite(std::vector<NamedFile>{{"recording", recording_}}, sources_of(scene));
    }
    scene_ = std::move(scene);
  });
}

void NextSession::prepare_now(std::optional<double> duration_s, bool no_cache) {
  state_ = State::kPreparing;
  work_ = std::async(std::launch::async, [this, duration_s, no_cache] {
    const devices::SignalStack signal_stack;
    session_ = prepare(std::move(*scene_), duration_s, no_cache, &broken_off_);
  });
}

}  // namespace palpate::app
