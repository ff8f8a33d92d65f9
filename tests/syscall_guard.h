#pragma once
#include <functional>

namespace palpate::tests {

/// Outcome of a program part under a system-call filter.
struct FilteredOutcome {
  bool done = false;    // the part ended under the filter
  int forbidden = -1;   // number of the first forbidden system call, -1: none
  int exit_status = 0;  // exit status of the child from waitpid
};

/// Marks the part of a program that runs under the filter.
class FilteredPart {
 public:
  virtual ~FilteredPart() = default;
  /// From now on the calling thread may only read clocks and sleep on them. Any other call ends the child.
  virtual void start() noexcept = 0;
  /// Ends the part. Later system calls, as at the end of the thread, are no finding.
  virtual void done() noexcept = 0;
};

/// Runs `part` in a child process, because a filter cannot be removed.
FilteredOutcome run_filtered(const std::function<void(FilteredPart&)>& part);

}  // namespace palpate::tests
