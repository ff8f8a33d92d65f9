#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "palpate/base/ring.h"
#include "palpate/haptics/loop.h"

namespace palpate::app {

/// Tells people how a run goes, from a thread of its own while the loop runs: a progress bar, and each fault
/// in words with the way to reset it. The loop only counts and leaves news in a ring.
class RunCompanion final {
 public:
  /// [setup] @param ticks of the whole run; @param devices one a hand; outlive this
  RunCompanion(std::string title, std::uint64_t ticks, double rate_Hz, std::vector<haptics::Device*> devices);
  /// Tells what is still untold.
  ~RunCompanion();
  RunCompanion(const RunCompanion&) = delete;
  RunCompanion& operator=(const RunCompanion&) = delete;

  /// For the loop's options.
  [[nodiscard]] std::atomic<std::uint64_t>& done() noexcept { return done_; }
  [[nodiscard]] Ring<haptics::FaultSeen>& fault_news() noexcept { return fault_news_; }

 private:
  static constexpr std::size_t kNewsKept = 64;

  void accompany(const std::stop_token& stop);
  void tell_fault(const haptics::FaultSeen& seen) const;

  std::string title_;
  std::uint64_t ticks_;
  double rate_Hz_;
  std::vector<haptics::Device*> devices_;
  std::atomic<std::uint64_t> done_{0};
  Ring<haptics::FaultSeen> fault_news_{kNewsKept};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace palpate::app
