#include "tests/syscall_guard.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <exception>
#include <iostream>
#include <new>

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::tests {
namespace {

/// Memory shared by child and parent.
struct Board {
  std::atomic<int> started{0};
  std::atomic<int> done{0};
  std::atomic<int> forbidden{-1};
};
Board* board = nullptr;  // global, because a signal handler has no argument for it

[[noreturn]] void leave(int code) noexcept {
  for (;;) syscall(SYS_exit_group, code);
}

/// Handles a forbidden call. It is a finding before the part is done; afterwards it is the end of the thread.
void on_forbidden(int, siginfo_t* info, void*) {
  if (board->done.load() == 0) board->forbidden.store(info->si_syscall);
  leave(board->done.load() == 0 ? 1 : 0);
}

constexpr std::array<unsigned, 5> kAllowed = {SYS_clock_gettime, SYS_clock_nanosleep, SYS_restart_syscall,
                                              SYS_rt_sigreturn, SYS_exit_group};

bool install_filter() noexcept {
  constexpr auto kNumber = static_cast<unsigned>(offsetof(seccomp_data, nr));
  std::array<sock_filter, 2 * kAllowed.size() + 2> program{};
  std::size_t size = 0;
  program[size++] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber);
  for (const unsigned call : kAllowed) {
    program[size++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    program[size++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  program[size++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  const sock_fprog filter{static_cast<unsigned short>(size), program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

class ChildPart final : public FilteredPart {
 public:
  void start() noexcept override {
    board->started.store(1);
    if (!install_filter()) leave(3);
  }
  void done() noexcept override { board->done.store(1); }
};

[[noreturn]] void run_child(const std::function<void(FilteredPart&)>& part) {
  struct sigaction action {};
  action.sa_sigaction = on_forbidden;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  try {
    ChildPart child;
    part(child);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    leave(2);
  }
  leave(0);
}

}  // namespace

FilteredOutcome run_filtered(const std::function<void(FilteredPart&)>& part) {
  void* shared = mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  board = new (shared) Board;
  const pid_t child = fork();
  if (child == 0) run_child(part);
  FilteredOutcome outcome;
  waitpid(child, &outcome.exit_status, 0);
  outcome.done = board->done.load() != 0;
  outcome.forbidden = board->forbidden.load();
  munmap(shared, sizeof(Board));
  board = nullptr;
  return outcome;
}

}  // namespace palpate::tests
