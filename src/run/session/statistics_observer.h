#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/scene.h"
#include "palpate/session.h"
#include "palpate/tick_observer.h"

namespace palpate::session {

/// Computes the statistics of a run while it goes on.
class StatisticsObserver final : public haptics::TickObserver {
 public:
  /// [setup]
  explicit StatisticsObserver(const scene::Scene& scene);

  void on_update(const haptics::ParameterUpdate& update) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [setup] After the run.
  [[nodiscard]] const RunStatistics& statistics() const noexcept { return statistics_; }

 private:
  void follow_phase(const haptics::TickRow& row) noexcept;
  void follow_force(const haptics::TickRow& row) noexcept;

  /// Values of a hand's previous row, for differences.
  struct LastRow {
    bool seen = false;
    double tissue_force = 0.0;      // N
    std::array<double, 3> force{};  // N
    std::array<double, 3> tool{};   // m
  };

  double period_;  // s
  std::uint64_t last_contact_tick_;
  std::uint64_t last_limited_tick_;
  std::vector<std::int64_t> open_span_;  // per hand: index into phases; -1: none, or kMaxSpans is reached
  std::vector<std::int64_t> last_phase_;
  std::vector<LastRow> last_row_;  // per hand
  RunStatistics statistics_;
};

}  // namespace palpate::session
