#pragma once
#include <functional>

namespace palpate::tests {

/// What became of a program part that ran under a system-call filter.
struct FilteredOutcome {
  bool done = false;    // it came to its end while filtered
  int forbidden = -1;   // number of the first system call that is not allowed, -1: none
  int exit_status = 0;  // of the child, as waitpid gives it
};

/// Marks that the filtered part is done; what follows (the thread's end) may call the system again.
class FilteredPart {
 public:
  virtual ~FilteredPart() = default;
  /// From here on the calling thread may only read clocks and sleep on them; anything else ends the child.
  virtual void start() noexcept = 0;
  virtual void done() noexcept = 0;
};

/// Runs `part` in a child process, so that a filter, which can never be taken off, ends with it.
FilteredOutcome run_filtered(const std::function<void(FilteredPart&)>& part);

}  // namespace palpate::tests
