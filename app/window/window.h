#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <SDL.h>
#include <sys/types.h>

#include "palpate/offscreen.h"
#include "run/palpation/insertion_score.h"

#include "app/live_run.h"
#include "app/next_session.h"
#include "app/run_tape.h"
#include "app/session.h"
#include "app/window/camera_controller.h"
#include "app/window/choices.h"
#include "app/window/display.h"
#include "app/window/live_picture.h"
#include "app/window/orbit_camera.h"
#include "app/window/panels.h"
#include "app/window/parameter_history.h"
#include "app/window/run_in_window.h"
#include "app/window/search.h"
#include "app/window/steering.h"
#include "app/window/support_editor.h"
#include "app/window/traces.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// Viewers of recordings opened from a window. Each is a separate process, so it cannot delay a haptic loop,
/// and it continues after the window closes. All members: [setup], one thread.
class Observers final {
 public:
  Observers() = default;
  ~Observers() { (void)count_running(); }
  Observers(const Observers&) = delete;
  Observers& operator=(const Observers&) = delete;

  /// Runs `program view recording`. @throws InputError naming the file if it is missing or the program does
  /// not start
  void open(const std::filesystem::path& program, const std::filesystem::path& recording);
  /// Number of viewers that still run.
  [[nodiscard]] std::size_t count_running();

 private:
  std::vector<pid_t> children_;
};

/// The window of `palpate run`: picture and panels. The session runs on other threads. All members: [setup],
/// the constructing thread.
class Window final {
 public:
  /// Opens the window; the first frame starts the run. @param request the overrides that `first` was made
  /// from @throws NoWindow
  Window(std::shared_ptr<Session> first, scene::Overrides request, WindowOptions options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Runs one frame: events, commands, drawing. @return false when the window is to close
  /// @throws DisplayLost; call finish() in that case, too
  bool frame();
  /// Ends a running session (zero force, recording closed). Call after the last frame. @throws InputError
  /// when the first session's recording could not be written
  [[nodiscard]] WindowOutcome finish();

  // State of the window, for tests and screenshots:
  /// The whole window as last drawn.
  [[nodiscard]] render::Image picture() const { return viewport_.picture(); }
  /// Draws every pixel from now on, whatever a frame takes.
  void hold_full_quality() { live_.hold_full_quality(); }
  /// Text at the top of the picture; empty: none.
  [[nodiscard]] const std::string& banner() const noexcept { return banner_; }
  /// Message at the picture's lower edge; empty: none.
  [[nodiscard]] const std::string& message() const noexcept { return viewport_.message(); }
  [[nodiscard]] const haptics::Snapshot& snapshot() const noexcept { return shown_; }
  [[nodiscard]] const Traces& traces() const noexcept { return *traces_; }
  [[nodiscard]] std::pair<int, int> mouse_at() const noexcept { return viewport_.mouse_at(); }
  [[nodiscard]] const Layout& layout() const noexcept { return layout_; }
  /// Where a point is in the window [window units]; nothing: behind the camera.
  [[nodiscard]] std::optional<std::pair<float, float>> in_window(const Vec3& point_W) const;
  [[nodiscard]] PanelState& panels() noexcept { return panels_; }
  [[nodiscard]] const LiveRun<RowObserver>& run() const noexcept { return *run_; }
  [[nodiscard]] bool preparing() const noexcept { return next_ != nullptr; }
  [[nodiscard]] double age() const noexcept { return age_; }
  [[nodiscard]] double frame_time() const noexcept { return frame_time_; }
  /// Whether a recording is being written.
  [[nodiscard]] bool recording() const;
  /// The search of a run of task palpate; null: another task.
  [[nodiscard]] const Search* search() const noexcept { return search_.get(); }

 private:
  // window_events.cc
  void take_event(const SDL_Event& event, std::pair<int, int> way);
  void key_down(const SDL_KeyboardEvent& key);
  void escape_key(const SDL_KeyboardEvent& key);
  void enter_key();
  void control_key(const SDL_Keysym& key);
  void letter_key(SDL_Keycode key);
  void view_key(const SDL_KeyboardEvent& key);
  void mouse_button(const SDL_MouseButtonEvent& button);
  void mouse_motion(std::pair<int, int> way);
  void point_the_tool();
  [[nodiscard]] std::optional<geometry::Ray> pointer_ray() const;
  void attach_at_pointer();
  [[nodiscard]] double aspect() const {
    return static_cast<double>(layout_.picture.width) / std::max(1.0F, layout_.picture.height);
  }
  void mouse_wheel(const SDL_MouseWheelEvent& wheel);
  void file_dropped(const std::filesystem::path& file);
  [[nodiscard]] bool over_picture(int x, int y) const { return Viewport::over(layout_.picture, x, y); }

  // window_runs.cc
  void take(std::shared_ptr<Session> session, std::filesystem::path recording);
  void begin();
  void poll_runs();
  void poll_next();
  void end_run();
  void close_run();
  void take_rows();
  void poll_search();
  void show_all_inclusions();
  void grant(const Commands& commands);
  void take_file(const ChosenFile& file);
  void keep_support();
  void pause_run();
  void apply_tissue(const model::TissueParameters& tissue);
  void apply_noise(const noise::NoiseSettings& noise);
  void apply_inclusion(const haptics::LiveInclusion& change);
  void apply_parameters(const Commands& commands);
  void apply_all(const LiveParameters& wanted);
  void undo_or_redo(bool undo);
  void restart(scene::Overrides request, Keep keep);
  [[nodiscard]] Selection selection() const;
  // window_recording.cc
  void record(bool on);
  void poll_recording();
  void end_recording();
  [[nodiscard]] std::filesystem::path recording_now() const;
  [[nodiscard]] bool searching() const { return search_ != nullptr && !search_->ended(); }
  [[nodiscard]] std::string recording_note() const;
  // window_runs.cc
  void look_at(const std::filesystem::path& recording);
  void make_renderer();
  [[nodiscard]] render::Subject subject() const;

  // window.cc
  void draw_frame();
  void settle_picture();
  void note_age();
  void take_newest();
  void compose();
  void draw_overlay();
  void show_preparing();
  void keep_in_frame();
  [[nodiscard]] Gestures gestures() const;
  void draw_picture();
  void recover_graphics();
  [[nodiscard]] PanelModel shown() const;
  [[nodiscard]] std::vector<HandStatus> hand_texts() const;
  [[nodiscard]] std::string banner_text(bool& fault) const;

  scene::Overrides request_;
  WindowOptions options_;
  std::filesystem::path last_recording_;
  Viewport viewport_;
  LivePicture live_;
  Observers observers_;
  bool reach_changed_ = false;  // the falloff ratios changed; the renderer has the old ones
  OrbitCamera camera_;
  CameraController camera_controller_{camera_};
  bool camera_set_ = false;
  Steering steering_;
  std::unique_ptr<Traces> traces_;
  std::unique_ptr<LiveRun<RowObserver>> run_;
  std::unique_ptr<RunTape> tape_;                          // of the run; null: it is recorded from its start
  bool run_closed_ = false;                                // close_run() was called
  bool ended_by_user_ = false;                             // the user ended the search or the insertion
  bool answered_ = false;                                  // what an insertion hid is shown
  std::unique_ptr<Search> search_;                         // of the run; null: another task
  std::optional<NeedleMarks> needle_;                      // of the run
  std::unique_ptr<palpation::InsertionScorer> insertion_;  // of the run; null: another task
  std::unique_ptr<SupportEditor> support_;  // of the run; null: task palpate, whose map takes the colours
  std::vector<SearchOutcome> searches_;
  std::unique_ptr<NextSession> next_;
  haptics::Snapshot shown_;
  bool snapshot_there_ = false;
  bool rest_there_ = false;  // the picture shows the organ at rest, until the first snapshot
  LiveParameters now_;       // of this run, or of the next one
  ParameterHistory history_;
  std::string tissue_note_;
  bool tissue_waits_ = false;  // until the run is resumed
  bool noise_waits_ = false;
  bool inclusions_wait_ = false;
  PanelState panels_;
  Commands commands_;  // of the keys; the panels add theirs
  Layout layout_;
  bool paused_ = false;
  bool leaving_ = false;
  EscapeGuard escape_;
  bool panel_used_ = false;    // later than the picture, so that Enter may be meant for the panel
  bool touched_ = false;       // a tool has touched the organ in this window
  bool mouse_inside_ = false;  // the mouse has moved in the window and not left it
  std::string banner_;
  std::int64_t frame_began_ns_ = 0;
  std::int64_t steered_ns_ = 0;  // when the devices got their last targets
  double frame_time_ = 0.0;
  double frames_a_second_ = 0.0;
  double age_ = 0.0;
  haptics::Histogram all_ages_;                       // ns
  std::deque<std::pair<std::int64_t, double>> ages_;  // of the last seconds
  std::optional<RunResult> first_result_;
  std::string first_failure_;
  bool first_ended_ = false;
  std::uint64_t runs_begun_ = 0;
  bool later_fault_ = false;
};

}  // namespace palpate::app
