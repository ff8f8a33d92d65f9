#pragma once
// What `palpate run` needs of the window. A build without a window (app/windows/window.cc) says so.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/run_control.h"
#include "palpate/scene.h"
#include "run/palpation/score.h"

#include "app/session.h"
#include "app/window/display.h"

namespace palpate::app {

/// Requested scale of text and panels; nothing: the scale follows the display's resolution.
struct UiScale {
  static constexpr double kLeast = 0.5;
  static constexpr double kMax = 4.0;

  /// [setup] Reads --ui-scale, else PALPATE_UI_SCALE. @throws InputError naming it unless it is a number from
  /// kLeast to kMax
  [[nodiscard]] static std::optional<float> asked(const std::string& flag);
};

/// A search of a window's session, after its end.
struct SearchOutcome {
  std::filesystem::path recording;  // empty: not recorded
  std::uint64_t seed = 0;           // of the places
  std::uint64_t rows_left_out = 0;  // that the window missed, so that the score is of the others
  palpation::AnyScore score;
};

/// Options of the window and of its sessions.
struct WindowOptions {
  // Of the first session; later ones get the names NAME-2.h5 and so on. Empty: none is recorded.
  std::filesystem::path recording;
  haptics::LoopThread thread;        // thread settings of every session's loop
  std::optional<double> duration_s;  // of every session
  bool no_cache = false;
  bool stays = true;  // the window stays open after the run; after a search that the user ends it always does
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C
  net::IgtlServer* igtl = nullptr;          // sends all runs to other programs; outlives the window
  Display::Size size{1440, 900};
  std::optional<float> scale;                       // of text and panels; nothing: from the display
  std::filesystem::path viewer = "/proc/self/exe";  // program whose `view` command opens a recording
};

/// Result of a window's sessions.
struct WindowOutcome {
  RunResult result;                       // result of the first session
  std::uint64_t more_runs = 0;            // sessions started in the window
  std::vector<SearchOutcome> searches{};  // of tasks palpate and insert, in their order
  bool later_fault = false;               // one of those had a fault
  std::uint64_t frames = 0;               // frames that showed a running session
  double median_age = 0.0;                // s, age of the shown snapshots
  double largest_age = 0.0;               // s
  bool display_lost = false;              // the window ended because the display was lost
};

/// [setup] Opens a window and runs its sessions until the user closes it. @throws as Window and finish() do
[[nodiscard]] WindowOutcome run_in_window(std::shared_ptr<Session> first, const scene::Overrides& request,
                                          const WindowOptions& options);

}  // namespace palpate::app
