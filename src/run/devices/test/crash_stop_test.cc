// Zero force before a fatal signal ends the program. Each case runs in a child process, in which a handler
// that was installed before the device sees what the device does at the end.
#include "run/devices/crash_stop.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "run/devices/forcedimension.h"
#include "run/devices/test/stand_in/dhd_stand_in_loaded.h"
#include "run/devices/test/stand_in/hd_stand_in_loaded.h"
#include "run/devices/touch.h"

namespace palpate::devices {
namespace {

using stand_in::Loaded;
using stand_in::LoadedHd;

constexpr int kZeroForce = 0;
constexpr int kForce = 1;

const haptics::ForceCommand kPush{Vec3(0.0, 0.0, 3.0), Vec3::Zero(), 0.0};

const stand_in::Device* dhd_witness = nullptr;
const LoadedHd* hd_witness = nullptr;

bool is_zero(const double* v) { return v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0; }

/// Ends the child process and reports whether a Force Dimension device was left without force.
extern "C" void exit_with_dhd_force(int) {
  _exit(is_zero(dhd_witness->force) && !dhd_witness->force_on && dhd_witness->brakes ? kZeroForce : kForce);
}

/// Ends the child process and reports whether a Touch was left without force.
extern "C" void exit_with_hd_force(int) {
  _exit(hd_witness->arm([](const stand_in::HdArm& arm) { return is_zero(arm.force); }) ? kZeroForce : kForce);
}

/// Installs the handler that sees the end. It works on an overflowed stack, too.
void watch_end(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK;
  sigaction(number, &action, nullptr);
}

/// A device whose loop goes on to write a force until the process ends.
void crash_while_a_loop_writes(int number) {
  const Loaded library(stand_in::file_of("dhd_stand_in"));
  dhd_witness = &library.device();
  watch_end(number, exit_with_dhd_force);
  ForceDimensionDevice device(library.path, 0);
  std::atomic<int> written{0};
  std::thread loop([&] {
    for (;;) {
      (void)device.write(kPush);
      ++written;
    }
  });
  while (written < 100) std::this_thread::yield();
  std::raise(number);
  loop.join();
}

TEST(CrashStop, SwitchesAForceDimensionDeviceOffAlthoughTheLoopWritesOn) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) {
    EXPECT_EXIT(crash_while_a_loop_writes(number), testing::ExitedWithCode(kZeroForce), "") << number;
  }
}

void abort_with_a_force(bool witness) {
  const Loaded library(stand_in::file_of("dhd_stand_in"));
  dhd_witness = &library.device();
  if (witness) watch_end(SIGABRT, exit_with_dhd_force);
  ForceDimensionDevice device(library.path, 0);
  (void)device.write(kPush);
  std::abort();
}

TEST(CrashStop, ActsOnAbortAndTheProgramThenDiesOfTheSameSignal) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(abort_with_a_force(true), testing::ExitedWithCode(kZeroForce), "");
  EXPECT_EXIT(abort_with_a_force(false), testing::KilledBySignal(SIGABRT), "");
}

void crash_with_a_touch() {
  const LoadedHd library;
  hd_witness = &library;
  watch_end(SIGSEGV, exit_with_hd_force);
  TouchDevice device("", PALPATE_HD_STAND_IN);
  while (library.arm([](const stand_in::HdArm& arm) { return is_zero(arm.force); }))
    (void)device.write(kPush);
  std::atomic<bool> crashed{false};
  std::thread loop([&] {
    while (!crashed) (void)device.write(kPush);
  });
  std::raise(SIGSEGV);
  crashed = true;
  loop.join();
}

TEST(CrashStop, LetsTheSchedulerOfATouchSendZeroForce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(crash_with_a_touch(), testing::ExitedWithCode(kZeroForce), "");
}

/// Calls itself until the stack of the thread overflows.
int overflow(int depth) {
  constexpr int kEndless = 1 << 30;
  volatile char page[4096];
  page[0] = static_cast<char>(depth);
  return depth == kEndless ? 0 : overflow(depth + 1) + page[0];
}

void overflow_with_a_force() {
  const Loaded library(stand_in::file_of("dhd_stand_in"));
  dhd_witness = &library.device();
  watch_end(SIGSEGV, exit_with_dhd_force);
  ForceDimensionDevice device(library.path, 0);
  (void)device.write(kPush);
  std::thread([] {
    const SignalStack stack;
    (void)overflow(0);
  }).join();
}

TEST(CrashStop, ActsOnTheOverflowOfAThreadsStack) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(overflow_with_a_force(), testing::ExitedWithCode(kZeroForce), "");
}

TEST(CrashStop, HasHandlersOnlyWhileADeviceIsOpen) {
  const auto handler = [] {
    struct sigaction now {};
    sigaction(SIGSEGV, nullptr, &now);
    return now.sa_handler;
  };
  const auto before = handler();
  {
    const CrashStop one;
    const auto during = handler();
    EXPECT_NE(during, before);
    { const CrashStop two; }
    EXPECT_EQ(handler(), during);
  }
  EXPECT_EQ(handler(), before);
}

}  // namespace
}  // namespace palpate::devices
