#include "app/signals.h"

#include <windows.h>

namespace palpate::app {
namespace {

// Mutable globals, because a handler has no arguments that could carry them.
std::atomic<bool> stop_asked{false};

/// Windows calls it on a thread of its own.
BOOL WINAPI ask_to_stop(DWORD event) {
  const bool second = stop_asked.exchange(true);
  if (event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT)
    return second ? FALSE : TRUE;  // FALSE ends the program
  // The console closes, or the session or the system ends. Windows ends the program when this function
  // returns, so it waits; the end of main() ends it before.
  constexpr DWORD kLongEnough = 30'000;  // ms; Windows itself waits 5 to 20 s
  Sleep(kLongEnough);
  return TRUE;
}

}  // namespace

StopOnSignal::StopOnSignal() : hangup_before_(nullptr) {
  stop_asked.store(false);
  (void)SetConsoleCtrlHandler(ask_to_stop, TRUE);
}

StopOnSignal::~StopOnSignal() {
  (void)hangup_before_;
  (void)SetConsoleCtrlHandler(ask_to_stop, FALSE);
}

const std::atomic<bool>& StopOnSignal::flag() const noexcept { return stop_asked; }

ResetOnSignal::ResetOnSignal() = default;
ResetOnSignal::~ResetOnSignal() = default;
bool ResetOnSignal::take() noexcept { return false; }

std::string describe_reset() { return "until the run ends"; }

const char* describe_faults() noexcept { return "A fault keeps the force at zero until the run ends.\n"; }

void ignore_signals() noexcept {}

}  // namespace palpate::app
