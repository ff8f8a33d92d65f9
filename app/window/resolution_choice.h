#pragma once
#include <cstddef>
#include <vector>

namespace palpate::app {

/// Chooses how many pixels are drawn a pixel shown by how long frames take, so that they stay within a
/// budget. Goes down when most of some frames in a row were slow, and up where there is clearly room, more
/// rarely each time that it had to go down again, so that it does not swing. All members: [any], one thread.
class ResolutionChoice final {
 public:
  static constexpr double kBudget = 30e-3;      // s, of a frame
  static constexpr std::size_t kUsual = 8;      // frames judged together
  static constexpr std::size_t kFew = 3;        // the same where it has to be quick
  static constexpr std::size_t kFirstWait = 8;  // judgements before it tries again what was too much

  /// Takes the time of one frame that drew a picture [s]. @param may_cheapen whether pictures can still
  /// become cheaper with as many pixels: that comes first, unless frames are very slow @param judged how many
  /// frames are judged together @return whether frames were judged just now, and need no fewer pixels
  bool add(double frame_time, bool may_cheapen, std::size_t judged = kUsual);
  /// Goes down, whatever time there is. @return whether it could
  bool lower() noexcept;
  /// All pixels from here on.
  void raise_to_all() noexcept { level_ = 0; }
  /// Forgets what frames took, not what was chosen.
  void forget_times() noexcept { times_.clear(); }

  /// Pixels drawn a pixel shown, a side.
  [[nodiscard]] double now() const noexcept;
  [[nodiscard]] bool all() const noexcept { return level_ == 0; }

 private:
  [[nodiscard]] bool fits(double usual, bool may_cheapen) noexcept;

  std::size_t level_ = 0;  // 0: all
  std::vector<double> times_;
  std::size_t wait_ = 0;  // judgements before it may go up
  std::size_t next_wait_ = kFirstWait;
  bool tried_ = false;  // it went up, and has not been judged since
};

}  // namespace palpate::app
