#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "run/palpation/score.h"

#include "app/session.h"
#include "app/window/live_picture.h"
#include "app/window/run_in_window.h"
#include "app/window/traces.h"

namespace palpate::app {

/// What the panel of a search shows.
struct SearchStatus {
  std::size_t lumps = 0;  // hidden
  std::size_t marks = 0;
  double coverage = 0.0;                    // share of the upper side, 0 to 1
  std::optional<palpation::Score> score{};  // after the end of the run
  bool shows_map = false;                   // the picture shows the felt stiffness
  double low = 1.0;                         // factors at the ends of the map's colours
  double high = 1.25;
  std::optional<double> pointer_gain{};  // of the mouse, below 1 over stiff places; none without a mouse
};

/// The search for hidden inclusions in a window's run (task palpate). All members: [setup], the window's
/// thread.
class Search final {
 public:
  /// @param session of the task palpate, must outlive this
  explicit Search(const Session& session);

  /// Adds a row of the run.
  void add(const haptics::TickRow& row) { scorer_.add(row); }
  /// Ends the search: the score is final.
  void end();
  /// Number of new presses of the button without contact since the last call; they mark nothing.
  [[nodiscard]] std::size_t take_untouched_marks();
  [[nodiscard]] bool ended() const noexcept { return score_.has_value(); }

  /// How far the pointer moves for a motion of the mouse, where the tissue was last pressed: the inverse cube
  /// of the felt stiffness over the uniform tissue's, 0.25 to 1. People take a slower pointer for a stiffer
  /// place (pseudo-haptics, docs/lumps.md).
  [[nodiscard]] double pointer_gain(const Traces& traces) const;
  [[nodiscard]] SearchStatus status() const;
  /// Colours the picture by the felt stiffness, and draws the marks; after the end also the lumps. At most
  /// five times a second, or now if `now`.
  void draw_on(LivePicture& picture, bool now);
  [[nodiscard]] const palpation::Scorer& scorer() const noexcept { return scorer_; }
  [[nodiscard]] const std::optional<palpation::Score>& score() const noexcept { return score_; }

  bool shows_map = false;

 private:
  void widen_range();

  const Session& session_;
  palpation::Scorer scorer_;
  std::optional<palpation::Score> score_;
  std::size_t untouched_ = 0;  // presses without contact that take_untouched_marks() has returned
  double low_ = 1.0;           // factors at the ends of the map's colours
  double high_ = 1.25;
  std::int64_t next_ns_ = 0;  // time of the next update of the picture
};

/// [any] The result of a search as one sentence: "2 of 3 lumps found, 1 false mark."
[[nodiscard]] std::string answer_text(const palpation::Score& score);

}  // namespace palpate::app
