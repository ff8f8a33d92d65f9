#pragma once
#include <cmath>
#include <cstdint>

#include "palpate/tick_row.h"

#include "study/session/trial_log.h"

namespace palpate::study {

inline constexpr double kFade = 50e-3;   // s, of noise and commanded force before an interval counts
inline constexpr double kSettle = 1.0;   // s, start of a hold (kForceControl) that is not averaged
inline constexpr double kFarAway = 1e3;  // m, d0 of a noise that does not depend on the distance

/// Measures a stimulus interval from its rows: in the run, and again when the log is compared with the
/// recording.
class IntervalMeter final {
 public:
  /// [setup] The next row. @param averaged whether it counts in the means @param target of a hold [N]
  void add(const haptics::TickRow& row, bool averaged, double target);

  /// [setup] Peak, mean, depth and work; without the ticks.
  [[nodiscard]] IntervalCues cues() const;
  [[nodiscard]] double depth() const noexcept { return cues_.depth; }
  [[nodiscard]] bool touched() const noexcept { return touched_; }
  /// [setup] Root mean square error [N] of a hold, and its coefficient of variation; 0 without averaged rows.
  [[nodiscard]] double rms_error() const;
  [[nodiscard]] double variation() const;

 private:
  IntervalCues cues_;
  double last_depth_ = 0.0;
  double force_sum_ = 0.0;
  double square_sum_ = 0.0;  // of force - target
  double force_square_ = 0.0;
  std::uint64_t averaged_ = 0;
  bool touched_ = false;
};

}  // namespace palpate::study
