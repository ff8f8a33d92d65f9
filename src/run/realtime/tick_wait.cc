#include "run/realtime/tick_wait.h"

#include <algorithm>

#include "io/system/clock.h"

namespace palpate::realtime {
namespace {

constexpr double kLeastRest = 0.05;   // fraction, for the kernel's threads on that core
constexpr double kRestBeyond = 0.03;  // fraction in addition to the throttled one, because sleeps are inexact
constexpr double kLongestDebt = 1.0;  // s, longest time whose sleep is made up later
constexpr double kShortest = 50e3;    // ns
constexpr double kMargin = 100e3;     // ns
constexpr double kShortestShare = 0.4;  // of a period, at high rates
constexpr double kMarginShare = 0.25;

/// Marks a spin loop for the processor.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

double polling_sleep_fraction(const std::optional<RealtimeBudget>& budget) noexcept {
  constexpr double kUsual = 0.05;  // where it cannot be read
  double asked = kUsual;
  if (budget) asked = 1.0 - static_cast<double>(budget->runtime_us) / static_cast<double>(budget->period_us);
  if (budget && budget->runtime_us < 0) asked = 0.0;
  return std::clamp(asked + kRestBeyond, kLeastRest, 1.0);
}

PollingSleep::PollingSleep(double rate_Hz, double share) noexcept
    : share_ns_(share * 1e9 / rate_Hz),
      most_owed_(share * 1e9 * kLongestDebt),
      shortest_(static_cast<std::int64_t>(std::min(kShortest, kShortestShare * 1e9 / rate_Hz))),
      margin_(static_cast<std::int64_t>(std::min(kMargin, kMarginShare * 1e9 / rate_Hz))) {}

std::int64_t PollingSleep::next(std::int64_t now, std::int64_t due) noexcept {
  owed_ = std::min(owed_ + share_ns_, most_owed_);
  const std::int64_t rest = std::min(static_cast<std::int64_t>(owed_), due - now - margin_);
  if (rest < shortest_) return 0;
  owed_ -= static_cast<double>(rest);
  return rest;
}

TickWait::TickWait(haptics::Waiting waiting, double rate_Hz)
    : waiting_(waiting),
      rest_(rate_Hz, waiting == haptics::Waiting::kPoll ? polling_sleep_fraction(realtime_budget()) : 0.0) {}

void TickWait::until(std::int64_t due) noexcept {
  if (waiting_ == haptics::Waiting::kSleep) {
    sleep_until_ns(due);
    return;
  }
  const std::int64_t now = monotonic_ns();
  const std::int64_t rest = rest_.next(now, due);
  if (rest > 0) sleep_until_ns(now + rest);
  while (monotonic_ns() < due) relax();
}

}  // namespace palpate::realtime
