#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/scene.h"
#include "palpate/tick_observer.h"
#include "palpate/tissue.h"
#include "palpate/touch_noise.h"

#include "app/window/file_chooser.h"
#include "app/window/traces.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// The panels, in the order of the keys F2 to F7.
enum class Panel { kScene, kTissue, kNoise, kDevice, kTiming, kPlots };
inline constexpr std::size_t kPanels = 6;

/// One hand's state in words, for the panels.
struct HandStatus {
  std::string device;       // kind and path
  std::string state;        // "pressing, 4.2 mm deep"
  std::string fault;        // empty: none
  std::string advice;       // what to do about it
  bool limited = false;     // the gate shortened a force in the last moments
  double engagement = 1.0;  // share of the force that is let through
};

/// What the panels show in one frame; valid for that frame.
struct PanelModel {
  const scene::Scene& setup;
  const scene::Overrides& request;
  const Traces& traces;
  const haptics::Snapshot& snapshot;
  const model::TissueParameters& tissue;  // as felt
  const noise::NoiseSettings& noise;      // as felt
  std::vector<HandStatus> hands;
  std::string recording{};  // file being written; empty: none
  std::string looked_at{};  // file that could be looked at: the same, or the last one; empty: none
  bool ended = false;       // the run has
  bool paused = false;      // the picture is
  bool pausing = false;     // the run is: no time passes
  bool may_pause = true;    // no hand holds a device
  bool preparing = false;   // the next session is being
  double frames_a_second = 0.0;
  double frame_time = 0.0;   // s, of the window's own work
  double age = 0.0;          // s, of what is shown, when it is shown
  double largest_age = 0.0;  // s, in the last seconds
  std::uint64_t rows_left_out = 0;
  std::string tissue_note{};  // why the last change was refused, or what to mind; empty: nothing
};

/// What the user has asked for in one frame, by panel or key.
struct Commands {
  std::optional<model::TissueParameters> tissue;
  std::optional<noise::NoiseSettings> noise;
  std::optional<scene::Overrides> request;  // another session; tissue and noise as that says
  std::optional<ChosenFile> file;
  bool again = false;  // start the session again with the same tissue and noise
  std::optional<bool> record;
  bool pause = false;      // the picture, or go on
  bool pause_run = false;  // the run, or go on
  bool screenshot = false;
  bool reset_faults = false;
  bool full_screen = false;
  bool home = false;  // the camera
  bool look = false;  // at the recording, in a window of its own
  bool leave = false;
};

/// Which panels are seen, and what the user is typing.
struct PanelState {
  std::array<bool, kPanels> open{true, true, true, true, true, true};
  bool hidden = false;  // all of them
  bool help = false;
  double user_threshold = 20e-3;  // N
  double noise_share = 0.6;
  FileChooser files;
};

/// How the window is shared out: the panels are beside the picture, never on it.
struct Layout {
  Rectangle picture;
  Rectangle left;    // scene, tissue, noise; width 0: not seen
  Rectangle right;   // device and safety, timing
  Rectangle bottom;  // plots
};

/// [any] @param scale of all things. A window too small for panels and picture has the picture alone.
[[nodiscard]] Layout lay_out(float width, float height, float scale, const PanelState& state);

/// What the plots show of a run.
struct Plotted {
  struct Hand {
    const std::deque<haptics::TickRow>& rows;  // of the time shown
    haptics::TickRow now;                      // the newest, or where the cursor is
  };
  const model::TissueParameters& tissue;  // whose law is drawn
  model::Direction direction = model::Direction::kPress;
  double rate_Hz = 1000.0;
  std::vector<Hand> hands{};
  std::size_t strong = 0;  // the hand whose lines are drawn strongly
  double from = 0.0;       // s
  double to = 8.0;
  std::optional<double> cursor{};  // s: what comes after it is drawn faintly over depth
};

// Each draws one panel (between ImGui's NewFrame and Render) and notes what is asked for.
void draw_left(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands);
void draw_right(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands);
void draw_plots(const Rectangle& place, const Plotted& plotted);
void draw_help(PanelState& state, bool mouse_steers, bool gamepad_steers);
[[nodiscard]] Plotted plotted(const PanelModel& shown);

/// [any] The words for a moment of one hand, with so many decimals: "pressing, 4.2 mm deep".
[[nodiscard]] std::string moment_text(const haptics::TickRow& row, int decimals);

/// A key and what it does.
struct KeyLine {
  const char* keys;
  const char* what;
};
/// A window "Keys" in the middle, while `open`; `more` draws below the lines.
void draw_keys(bool& open, std::span<const KeyLine> lines, const std::function<void()>& more);
/// Lines of keys, as a table.
void draw_key_lines(const char* name, std::span<const KeyLine> lines);
/// A heading that opens and closes its panel. @return whether it is open
[[nodiscard]] bool panel_heading(const char* text, bool& open);
/// Begins the ImGui window of a column of panels.
void begin_column(const char* name, const Rectangle& place);

// The parts of the above that have a file of their own.
void scene_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void tissue_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void noise_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void device_panel(const PanelModel& shown, Commands& commands);
void timing_panel(const PanelModel& shown);

}  // namespace palpate::app
