#include "app/progress_observer.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <utility>

#include <unistd.h>

#include "core/base/text.h"

#include "app/messages.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

constexpr std::chrono::milliseconds kRedraw{100};

std::string seconds(double time) { return shortest(std::round(time * 10.0) / 10.0) + " s"; }

}  // namespace

ProgressObserver::ProgressObserver(const session::Session& session)
    : session_(session), thread_([this](const std::stop_token& stop) { report_progress(stop); }) {}

ProgressObserver::~ProgressObserver() {
  thread_.request_stop();
  thread_.join();
}

void ProgressObserver::report_progress(const std::stop_token& stop) {
  Progress bar(session_.setup().name);
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  bool told_warm = false;
  for (bool last = false; !last;) {
    last = wake.wait_for(lock, stop, kRedraw, [&stop] { return stop.stop_requested(); });
    haptics::FaultSeen seen;
    while (faults_.pop(seen)) {
      bar.clear();
      report_fault(seen);
    }
    const int hand = warm_hand_.load(std::memory_order_relaxed);
    if (hand >= 0 && !told_warm &&
        session_.setup().devices[static_cast<std::size_t>(hand)].kind != "replay") {
      bar.clear();
      app::report_message(describe_warm_motors(static_cast<std::size_t>(hand)));
      told_warm = true;
    }
    {
      const std::scoped_lock errors(mutex_);
      if (!errors_.empty()) bar.clear();
      for (const std::string& error : std::exchange(errors_, {})) report_error(error);
    }
    if (last) break;
    const auto ticks = static_cast<double>(done_.load(std::memory_order_relaxed));
    bar.update(ticks / static_cast<double>(session_.ticks()), seconds(ticks / session_.setup().rate_Hz));
  }
}

std::string ProgressObserver::describe_warm_motors(std::size_t hand) const {
  const bool lowers = std::isfinite(session_.setup().devices[hand].abilities.continuous_force);
  return "hand " + std::to_string(hand) + ": the device's motors are warm: pause for some minutes; " +
         (lowers ? "its force is reduced until they have cooled"
                 : "its force is not reduced, because it does not report its continuous force");
}

void ProgressObserver::report_fault(const haptics::FaultSeen& seen) const {
  const std::string trouble = session_.devices()[seen.hand]->last_error();
  report_error("fault at tick " + std::to_string(seen.tick) + " (" +
               shortest(static_cast<double>(seen.tick) / session_.setup().rate_Hz) + " s), hand " +
               std::to_string(seen.hand) + ": " + haptics::describe(seen.fault) +
               (trouble.empty() ? "" : " (" + trouble + ")") +
               "; the force stays zero until it is reset: kill -USR1 " + std::to_string(getpid()));
}

}  // namespace palpate::app
