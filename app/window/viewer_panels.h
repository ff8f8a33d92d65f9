#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "app/recorded_view.h"
#include "app/window/panels.h"
#include "app/window/replay_thread.h"

namespace palpate::app {

/// The viewer's panels, in the order of the keys F2 to F4.
enum class ViewerPanel { kRecording, kMoment, kPicture };

/// Visibility of a viewer's panels, and the settings of its picture.
struct ViewerState {
  static constexpr double kLeastMap = 0.1e-3;  // m
  static constexpr double kMaxMap = 0.1;

  std::array<bool, 3> open{true, true, true};
  bool plots = true;
  bool hidden = false;  // all panels
  bool help = false;
  std::uint32_t hand = 0;    // hand whose numbers are shown
  bool map = false;          // the organ is coloured by its displacement
  double map_range = 10e-3;  // m
  bool close_up = false;     // of the first view
  bool drape = false;        // under the organ
  FileChooser files;
};

/// Values that a viewer shows in one frame; valid for that frame.
struct ViewerModel {
  const RecordedView& view;
  const Overview& overview;
  const Playback& playback;
  std::uint64_t tick = 0;  // shown tick
  const ActiveParameters& active_parameters;
  const std::vector<std::deque<haptics::TickRow>>& rows;  // per hand, within the plotted time
  double from = 0.0;                                      // s, start of the plotted time
  double to = 8.0;
  bool there = true;   // the shown tick is the requested one
  bool still = false;  // the picture is drawn at full quality
};

/// The user's commands to a viewer in one frame, by panel or key.
struct ViewerCommands {
  std::optional<std::uint64_t> go_to;  // tick
  bool play = false;                   // play or stop
  std::int64_t ticks = 0;              // ticks to step
  std::int64_t pictures = 0;
  double seconds = 0.0;
  std::optional<std::size_t> speed;
  std::optional<std::uint32_t> hand;
  std::optional<std::string> open;  // file of another recording
  bool home = false;                // restore the first view
  bool save_window = false;
  bool save_picture = false;
  bool full_screen = false;
  bool leave = false;
};

/// Layout of a viewer's window.
struct ViewerLayout {
  Rectangle picture;
  Rectangle left;      // panels; width 0: hidden
  Rectangle timeline;  // height 0: hidden
  Rectangle plots;
};

/// [any] Lays the window out. If there is too little space for everything, the picture fills it. @param scale
/// of text and panels
[[nodiscard]] ViewerLayout lay_out(float width, float height, float scale, const ViewerState& state);

// Each function draws one part (between ImGui's NewFrame and Render) and adds the user's commands.
void draw_viewer_panels(const Rectangle& place, const ViewerModel& seen, ViewerState& state,
                        ViewerCommands& commands);
void draw_timeline(const Rectangle& place, const ViewerModel& seen, const ViewerState& state,
                   ViewerCommands& commands);
void draw_viewer_help(ViewerState& state);
/// Draws the colour scale of the displacement map at the picture's upper right, below `top`.
void draw_map_scale(const Rectangle& picture, float top, double range);

}  // namespace palpate::app
