#include "run/devices/crash_stop.h"

#include <csignal>

#include <windows.h>

namespace palpate::devices {
namespace {

constexpr ULONG kReservedStack = 1 << 16;  // bytes, for the handler after a stack overflow

// Mutable globals, because a handler has no arguments that could carry them.
LPTOP_LEVEL_EXCEPTION_FILTER filter_before = nullptr;
void (*abort_before)(int) = SIG_DFL;

void stop_once() noexcept {
  if (begin_crash()) return;
  stop_devices();
  Sleep(static_cast<DWORD>(CrashStop::kLastWords / 1'000'000));
}

LONG WINAPI stop_after_exception(EXCEPTION_POINTERS* exception) {
  stop_once();
  return filter_before != nullptr ? filter_before(exception) : EXCEPTION_CONTINUE_SEARCH;
}

extern "C" void stop_after_abort(int number) {
  stop_once();
  std::signal(number, abort_before);
  std::raise(number);
}

}  // namespace

void install_crash_handlers() {
  filter_before = SetUnhandledExceptionFilter(stop_after_exception);
  abort_before = std::signal(SIGABRT, stop_after_abort);
}

void restore_crash_handlers() {
  (void)SetUnhandledExceptionFilter(filter_before);
  std::signal(SIGABRT, abort_before);
}

struct SignalStack::Stack {};

SignalStack::SignalStack() {
  ULONG bytes = kReservedStack;
  (void)SetThreadStackGuarantee(&bytes);
}

SignalStack::~SignalStack() = default;

}  // namespace palpate::devices
