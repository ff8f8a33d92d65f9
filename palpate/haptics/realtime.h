#pragma once
#include <csignal>
#include <string>
#include <vector>

namespace palpate::haptics {

/// [setup] Asks for SCHED_FIFO for the calling thread. @return whether it was granted; if not, `remarks` says
/// so in words.
bool ask_for_priority(std::vector<std::string>& remarks);

/// [setup] Touches the calling thread's stack, so that no tick meets a page of it for the first time.
void touch_stack() noexcept;

/// Keeps the program's memory from being paged out while it lives, where that is allowed.
class MemoryLock final {
 public:
  /// [setup] @param remarks says in words when it is not allowed
  explicit MemoryLock(std::vector<std::string>& remarks);
  ~MemoryLock();
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  [[nodiscard]] bool granted() const noexcept { return granted_; }

 private:
  bool granted_;
};

/// Signals from outside wait while this lives, and so in every thread started meanwhile: Ctrl-C is for the
/// main thread.
class SignalsHeld final {
 public:
  SignalsHeld() noexcept;
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

}  // namespace palpate::haptics
