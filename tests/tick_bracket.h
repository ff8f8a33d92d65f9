#pragma once
#include <cstdint>

#include "palpate/tick_observer.h"

namespace palpate::tests {

/// Calls `begin` before the first tick and `end` after the last tick, on the loop's thread. Pass it as the
/// last observer, so that the work of the others is in between.
template <typename Begin, typename End>
class Bracket final : public haptics::TickObserver {
 public:
  Bracket(std::uint64_t ticks, Begin begin, End end) : left_(ticks), begin_(begin), end_(end) {}
  void on_start(std::int64_t /*started_unix_ns*/) noexcept override { begin_(); }
  void on_row(const haptics::TickRow& row) noexcept override {
    if (row.phase != 0) ++touching;
  }
  void on_tick(const haptics::TickState& /*now*/) noexcept override {
    if (--left_ == 0) end_();
  }
  std::uint64_t touching = 0;

 private:
  std::uint64_t left_;
  Begin begin_;
  End end_;
};

}  // namespace palpate::tests
