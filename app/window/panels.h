#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <imgui.h>

#include "palpate/parameter_updates.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"
#include "palpate/tissue.h"
#include "palpate/touch_noise.h"
#include "run/palpation/score.h"

#include "app/window/file_chooser.h"
#include "app/window/picture_marks.h"
#include "app/window/scene_gallery.h"
#include "app/window/search.h"
#include "app/window/support_editor.h"
#include "app/window/traces.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// The panels, in the order of the keys F2 to F7.
enum class Panel { kScene, kTissue, kNoise, kDevice, kTiming, kPlots };
inline constexpr std::size_t kPanels = 6;

/// One hand's state as text, for the panels.
struct HandStatus {
  std::string device;       // kind and path
  std::string state;        // "pressing, 4.2 mm deep"
  std::string fault;        // empty: none
  std::string advice;       // what to do about it
  bool limited = false;     // the force was limited in the last moments
  double engagement = 1.0;  // gain of the force ramp, 0 to 1
};

/// Values that the panels show in one frame; valid for that frame.
struct PanelModel {
  const scene::Scene& scene;
  const scene::Overrides& request;
  const Traces& traces;
  const haptics::Snapshot& snapshot;
  const model::TissueParameters& tissue;  // in force
  const noise::NoiseSettings& noise;      // in force
  std::vector<HandStatus> hands;
  std::string recording{};       // file being written; empty: none
  bool records_run = false;      // that file is of the whole run, so that it ends with the run (--record)
  std::string recording_note{};  // what is recorded, since when
  std::string looked_at{};  // file that the viewer could open: this one, or the previous one; empty: none
  bool ended = false;       // the run has ended
  bool paused = false;      // the picture is held, the run continues
  bool pausing = false;     // the run is paused: its time stands still
  bool may_pause = true;    // false while a hand holds a device
  bool preparing = false;   // the next session is being prepared
  double frames_a_second = 0.0;
  double frame_time = 0.0;   // s, work of the window
  double age = 0.0;          // s, age of the snapshot when it is shown
  double largest_age = 0.0;  // s, within the last seconds
  std::uint64_t rows_left_out = 0;
  std::span<const scene::InclusionSetup> inclusions{};  // in force, visible and hidden
  std::optional<SearchStatus> search{};                 // of task palpate
  bool inserts = false;                                 // task insert
  std::vector<palpation::Measure> insertion{};          // of task insert, after the end of the run
  std::optional<SupportStatus> support{};               // of other tasks
  bool can_undo = false;
  bool can_redo = false;
  std::string tissue_note{};  // why the last change was rejected, or a warning; empty: nothing
};

/// What the next session takes over from this one: the parameters in force instead of its scene's.
struct Keep {
  bool tissue = false;
  bool noise = false;
  bool inclusions = false;

  /// All of it, for another tool or device.
  [[nodiscard]] static Keep all() { return {true, true, true}; }
};

/// The user's commands of one frame, by panel or key.
struct Commands {
  std::optional<model::TissueParameters> tissue;
  std::optional<noise::NoiseSettings> noise;
  std::optional<haptics::LiveInclusion> inclusion;
  std::optional<scene::Overrides> request;     // start another session
  Keep keep{};                                 // what that session takes over
  const scene::BuiltinScene* scene = nullptr;  // start a session of this scene
  std::optional<ChosenFile> file;
  bool again = false;          // restart the session with the same tissue and noise
  std::optional<bool> record;  // begin a recording of this run, or end it; the run goes on
  bool pause = false;          // hold the picture, or release it
  bool pause_run = false;      // pause the run, or resume it
  bool screenshot = false;
  bool reset_faults = false;
  bool full_screen = false;
  bool home = false;         // restore the first view
  std::optional<bool> undo;  // the last change of parameters; false: redo
  bool look = false;         // open the recording in a viewer
  bool leave = false;
  std::optional<bool> map;  // of the felt stiffness
  bool end_search = false;  // or the insertion
  std::optional<SupportChange> support;
};

/// The question before the window closes while it records.
enum class LeaveDialog { kClosed, kOpening, kOpen };

/// Visibility of the panels, and the state of their input fields.
struct PanelState {
  std::array<bool, kPanels> open{true, true, true, true, true, true};
  bool hidden = false;  // all panels
  bool help = false;
  PictureMarks marks;
  bool drape = false;             // under the organ; a turning view takes longer with it
  double user_threshold = 20e-3;  // N, touch threshold of the user
  double noise_share = 0.6;       // fraction of the threshold
  FileChooser files;
  SceneGallery gallery;
  LeaveDialog leave = LeaveDialog::kClosed;

  /// Whether a dialog has the keyboard.
  [[nodiscard]] bool dialog_is_open() const noexcept {
    return files.is_open() || gallery.is_open() || leave != LeaveDialog::kClosed;
  }
};

/// Layout of the window. The panels are beside the picture, never on it.
struct Layout {
  Rectangle picture;
  Rectangle left;    // scene, tissue, noise; width 0: hidden
  Rectangle right;   // device and safety, timing
  Rectangle bottom;  // plots
};

/// [any] Lays the window out. If there is too little space for panels and picture, the picture fills it.
/// @param scale of text and panels
[[nodiscard]] Layout lay_out(float width, float height, float scale, const PanelState& state);

/// Data of the plots.
struct Plotted {
  struct Hand {
    const std::deque<haptics::TickRow>& rows;  // within the plotted time
    haptics::TickRow now;                      // newest row, or the row at the cursor
  };
  const model::TissueParameters& tissue;  // the plotted law
  model::Direction direction = model::Direction::kPress;
  double rate_Hz = 1000.0;
  std::vector<Hand> hands{};
  std::size_t strong = 0;  // hand with the stronger lines
  double from = 0.0;       // s, start of the plotted time
  double to = 8.0;
  std::optional<double> cursor{};  // s; force over depth is drawn faintly after it
};

// Each function draws one panel (between ImGui's NewFrame and Render) and adds the user's commands.
void draw_left(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands);
void draw_right(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands);
void draw_leave_dialog(const PanelModel& shown, PanelState& state, Commands& commands);
void draw_plots(const Rectangle& place, const Plotted& plotted);
/// What the present run can do, for the list of keys.
struct Gestures {
  bool mouse = false;      // holds a tool
  bool gamepad = false;    // holds a tool
  bool jaws = false;       // a tool has jaws
  bool search = false;     // task palpate
  bool needle = false;     // goes into layers
  bool may_pause = false;  // no hand holds a device
  std::size_t hands = 1;
};
void draw_help(PanelState& state, const Gestures& gestures);
/// [any] How to press and grip; empty: a device of its own does that.
[[nodiscard]] std::string first_hint(const Gestures& gestures);
[[nodiscard]] Plotted plotted(const PanelModel& shown);

/// [any] A hand's contact as text with this number of decimals: "pressing, 4.2 mm deep".
[[nodiscard]] std::string moment_text(const haptics::TickRow& row, const model::TissueParameters& tissue,
                                      int decimals);

/// A key and its effect.
struct KeyLine {
  const char* keys;
  const char* what;
};
/// Draws the window "Keys" while `open`; `more` draws below the lines.
void draw_keys(bool& open, std::span<const KeyLine> lines, const std::function<void()>& more);
/// Draws a table of keys.
void draw_key_lines(const char* name, std::span<const KeyLine> lines);
/// Draws the heading that opens and closes a panel. @return whether the panel is open
[[nodiscard]] bool panel_heading(const char* text, bool& open);
/// Begins the ImGui window of a column of panels.
void begin_column(const char* name, const Rectangle& place);

// Single panels, each in a source file of its own.
void scene_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void search_panel(const PanelModel& shown, Commands& commands);
/// The end of an insertion, then its score, which would show during it where a hidden target is.
void insertion_panel(const PanelModel& shown, Commands& commands);
void tissue_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void noise_panel(const PanelModel& shown, PanelState& state, Commands& commands);
void device_panel(const PanelModel& shown, Commands& commands);
void timing_panel(const PanelModel& shown);

/// Table of two columns, a name and its value. The destructor ends the table. [setup]
class Rows final {
 public:
  /// @param share fraction of the width for the names
  explicit Rows(const char* name, float share = 0.44F);
  ~Rows();
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// Writes the name of the next row; the next widget is drawn beside it. @param explanation tooltip of the
  /// name
  void name(const char* text, const char* explanation = nullptr) const;
  /// Writes a row of text.
  void text(const char* text, const std::string& value, const char* explanation = nullptr) const;
  /// Draws a row with a number that can be dragged, or typed after a double click.
  /// @param per_unit SI value of one displayed unit @param format of printf, with the unit
  /// @return whether the number was changed
  bool number(const char* text, double& value, double per_unit, double speed, double least, double most,
              const char* format, const char* explanation = nullptr) const;

 private:
  bool drawn_;
};

/// [setup] A number formatted by printf.
[[nodiscard]] std::string formatted(const char* format, double value);

}  // namespace palpate::app
