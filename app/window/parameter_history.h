#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "app/next_session.h"

namespace palpate::app {

/// [any] Whether two sets of parameters are equal.
[[nodiscard]] bool equal(const LiveParameters& a, const LiveParameters& b);

/// Undo and redo of tissue, touch noise and inclusions. All members: [setup], one thread.
class ParameterHistory final {
 public:
  static constexpr std::size_t kMaxSteps = 200;

  /// Call it once a frame. @param held whether a panel's widget is held: its changes until it is released are
  /// one step
  void next_frame(bool held) noexcept {
    if (!held) one_step_ = false;
  }
  /// Keeps the parameters before a change. @param held as for next_frame()
  void add(const LiveParameters& before, bool held);
  /// The parameters before the last step that is not undone. @param now in force @return nothing: there is
  /// none
  [[nodiscard]] std::optional<LiveParameters> undo(const LiveParameters& now) {
    return move(now, past_, future_);
  }
  /// The parameters that the last undo() replaced. @param now in force @return nothing: there are none
  [[nodiscard]] std::optional<LiveParameters> redo(const LiveParameters& now) {
    return move(now, future_, past_);
  }
  /// Forgets all steps; another session has other parameters.
  void clear();
  [[nodiscard]] bool can_undo() const noexcept { return !past_.empty(); }
  [[nodiscard]] bool can_redo() const noexcept { return !future_.empty(); }

 private:
  using Steps = std::vector<LiveParameters>;
  [[nodiscard]] std::optional<LiveParameters> move(const LiveParameters& now, Steps& from, Steps& to);

  Steps past_;             // the newest last
  Steps future_;           // the next one last
  bool one_step_ = false;  // changes belong to the last step
};

}  // namespace palpate::app
