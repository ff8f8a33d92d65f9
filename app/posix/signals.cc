#include "app/signals.h"

#include <array>
#include <csignal>

#include <unistd.h>

namespace palpate::app {
namespace {

/// Set by the handler of SIGINT, SIGTERM and SIGHUP. It is a mutable global because a signal handler has no
/// arguments that could carry it.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);
constexpr std::array<int, 3> kStopSignals{SIGINT, SIGTERM, SIGHUP};

extern "C" void ask_to_stop(int) { stop_asked.store(true, std::memory_order_relaxed); }

/// Set by the handler of SIGUSR1: reset the faults of all hands.
std::atomic<bool> reset_asked{false};

extern "C" void ask_for_reset(int) { reset_asked.store(true, std::memory_order_relaxed); }

}  // namespace

StopOnSignal::StopOnSignal() : hangup_before_(std::signal(SIGHUP, SIG_IGN)) {
  stop_asked.store(false);
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  sigemptyset(&action.sa_mask);
  for (const int number : kStopSignals) {
    // A second Ctrl-C ends the program. A terminal that closes sends SIGHUP twice by itself.
    action.sa_flags = number == SIGHUP ? 0 : static_cast<int>(SA_RESETHAND);
    sigaction(number, &action, nullptr);
  }
  if (hangup_before_ == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

StopOnSignal::~StopOnSignal() {
  for (const int number : kStopSignals) std::signal(number, SIG_DFL);
  std::signal(SIGHUP, hangup_before_);
}

const std::atomic<bool>& StopOnSignal::flag() const noexcept { return stop_asked; }

ResetOnSignal::ResetOnSignal() {
  reset_asked.store(false);
  struct sigaction action {};
  action.sa_handler = ask_for_reset;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGUSR1, &action, nullptr);
}

ResetOnSignal::~ResetOnSignal() { std::signal(SIGUSR1, SIG_IGN); }

bool ResetOnSignal::take() noexcept {
  return reset_asked.load(std::memory_order_relaxed) &&
         reset_asked.exchange(false, std::memory_order_relaxed);
}

std::string describe_reset() { return "until it is reset: kill -USR1 " + std::to_string(getpid()); }

const char* describe_faults() noexcept {
  return "A fault keeps the force at zero until it is reset; kill -USR1 PID resets the faults of all "
         "hands.\n";
}

void ignore_signals() noexcept {
  // With SIGXFSZ ignored, write() returns an error for a file over the limit of `ulimit -f`, as for a full
  // disk.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGUSR1, SIG_IGN);  // a reset of faults has no effect before a run and after it
}

}  // namespace palpate::app
