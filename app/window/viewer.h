#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <SDL.h>

#include "app/recorded_view.h"
#include "app/window/camera_controller.h"
#include "app/window/live_picture.h"
#include "app/window/orbit_camera.h"
#include "app/window/replay_thread.h"
#include "app/window/viewer_panels.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// Recording with the derived data of a viewer.
struct OpenRecording {
  /// [setup] Any thread. @throws InputError as RecordedView does
  OpenRecording(const std::filesystem::path& file, bool no_cache);
  explicit OpenRecording(std::unique_ptr<RecordedView> seen);

  std::unique_ptr<RecordedView> view;
  Overview overview;
  std::vector<render::Camera> whole;     // one per hand
  std::vector<render::Camera> close_up;  // one per hand
};

/// Options of a viewer.
struct ViewerOptions {
  std::optional<double> at_s;  // start time; nothing: 0
  double map_range = 0.0;      // m, largest displacement in the map; 0: no map
  bool close_up = false;
  bool drape = false;
  bool no_cache = false;
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C
  Display::Size size{1440, 900};
  std::optional<float> scale;  // of text and panels; nothing: from the display
};

/// The window of `palpate view`: picture, plots and numbers of a recording at any time. All members: [setup],
/// the constructing thread.
class Viewer final {
 public:
  /// @throws NoWindow
  Viewer(std::unique_ptr<RecordedView> seen, const ViewerOptions& options);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Runs one frame. @return false when the window is to close @throws DisplayLost
  bool frame();

  // State of the window, for tests and screenshots:
  [[nodiscard]] render::Image picture() const { return viewport_.picture(); }
  /// Organ and tool at the shown tick, as drawn by `palpate view --screenshot`.
  [[nodiscard]] render::Image still_picture();
  [[nodiscard]] const RecordedView& view() const noexcept { return *open_->view; }
  [[nodiscard]] const Overview& overview() const noexcept { return open_->overview; }
  [[nodiscard]] const haptics::Snapshot& snapshot() const noexcept { return shown_; }
  [[nodiscard]] const Playback& playback() const noexcept { return *playback_; }
  [[nodiscard]] const ViewerLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] ViewerState& state() noexcept { return state_; }
  [[nodiscard]] Viewport& viewport() noexcept { return viewport_; }
  [[nodiscard]] const std::string& banner() const noexcept { return banner_; }
  [[nodiscard]] const std::string& message() const noexcept { return viewport_.message(); }
  /// Whether the shown tick is the requested one.
  [[nodiscard]] bool there() const noexcept { return there_; }
  /// Whether the picture is drawn at full quality, as in a file.
  [[nodiscard]] bool still() const noexcept { return still_shown_; }

 private:
  // viewer_events.cc
  void take_event(const SDL_Event& event, std::pair<int, int> way);
  void key_down(const SDL_KeyboardEvent& key);
  void panel_key(SDL_Keycode which);
  void time_key(const SDL_KeyboardEvent& key);
  void letter_key(SDL_Keycode which);
  void mouse_button(const SDL_MouseButtonEvent& button);
  void grant(const ViewerCommands& commands);

  // viewer.cc
  void show(std::unique_ptr<OpenRecording> open);
  void begin_to_open(const std::filesystem::path& file);
  void poll_opening();
  void go_on();
  void save_memory();
  void gather_rows();
  void compose();
  void draw_overlay();
  void draw_picture();
  void draw_still(const PixelRectangle& place, const render::Camera& camera);
  [[nodiscard]] const render::Camera& first_camera() const;
  [[nodiscard]] std::string banner_text() const;

  ViewerOptions options_;
  Viewport viewport_;
  LivePicture live_;
  bool live_knows_ = false;  // live_ draws the open recording
  std::unique_ptr<OpenRecording> open_;
  std::unique_ptr<ReplayThread> ticks_;  // destroyed before open_
  std::optional<Playback> playback_;
  haptics::Snapshot shown_;
  bool snapshot_there_ = false;
  bool there_ = false;
  ActiveParameters active_parameters_;
  std::vector<std::deque<haptics::TickRow>> rows_;               // per hand, within the plotted time
  std::pair<std::uint64_t, std::uint64_t> ticks_plotted_{1, 0};  // first and last tick of rows_
  OrbitCamera camera_;
  CameraController camera_controller_{camera_};
  ViewerState state_;
  ViewerCommands commands_;  // of the keys; the panels add theirs
  ViewerLayout layout_;

  // Picture at full quality, drawn while nothing moves:
  std::unique_ptr<render::OffscreenRenderer> still_;
  bool stills_fit_ = true;  // a second renderer fits in the graphics card's memory
  std::uint64_t still_tick_ = 0;
  render::Camera still_camera_;
  Display::Size still_size_;
  double still_map_ = 0.0;
  bool still_drape_ = false;
  bool still_shown_ = false;
  std::int64_t moved_ns_ = 0;  // time of the last motion
  render::Camera last_camera_;

  // Recording that is being opened:
  std::future<std::unique_ptr<OpenRecording>> next_;
  std::string next_name_;

  bool leaving_ = false;
  std::string banner_;
  std::int64_t frame_began_ns_ = 0;
};

/// [setup] Shows a recording in a window until the user closes it. @throws NoWindow
void view_in_window(std::unique_ptr<RecordedView> seen, const ViewerOptions& options);

}  // namespace palpate::app
