#pragma once
#include <cstddef>
#include <vector>

namespace palpate::app {

/// Chooses the resolution of the picture from measured frame times, so that they stay within a budget. It
/// goes down when the median time of several frames exceeds the budget, and up when the median is clearly
/// below it. Each time it goes down again right after a rise, the wait before the next rise doubles, so that
/// the resolution does not oscillate. All members: [any], one thread.
class ResolutionChoice final {
 public:
  static constexpr double kBudget = 30e-3;      // s per frame
  static constexpr std::size_t kUsual = 8;      // frames judged together
  static constexpr std::size_t kFew = 3;        // frames judged together before the run
  static constexpr std::size_t kFirstWait = 8;  // judgements before the first retry

  /// Adds the time [s] of a frame that drew a picture. @param may_cheapen whether a lower quality is still
  /// possible at this resolution; then the resolution only falls when frames are very slow @param judged
  /// number of frames judged together @return whether frames were just judged and are within the budget or
  /// cannot become cheaper
  bool add(double frame_time, bool may_cheapen, std::size_t judged = kUsual);
  /// Goes down one level. @return false at the lowest level
  bool lower() noexcept;
  /// Draws every pixel from now on.
  void raise_to_all() noexcept { level_ = 0; }
  /// Discards the frame times, but keeps the resolution.
  void forget_times() noexcept { times_.clear(); }

  /// Drawn pixels per shown pixel, along one side.
  [[nodiscard]] double now() const noexcept;
  [[nodiscard]] bool all() const noexcept { return level_ == 0; }

 private:
  [[nodiscard]] bool fits(double usual, bool may_cheapen) noexcept;

  std::size_t level_ = 0;  // 0: every pixel
  std::vector<double> times_;
  std::size_t wait_ = 0;  // judgements until it may go up
  std::size_t next_wait_ = kFirstWait;
  bool tried_ = false;  // it went up and has not been judged since
};

}  // namespace palpate::app
