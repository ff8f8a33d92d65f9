#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "app/recorded_view.h"
#include "app/window/overview.h"
#include "app/window/panels.h"
#include "app/window/playback.h"

namespace palpate::app {

/// The viewer's panels, in the order of the keys F2 to F4.
enum class ViewerPanel { kRecording, kMoment, kPicture };

/// Which panels of a viewer are seen, and how the picture is wanted.
struct ViewerState {
  static constexpr double kLeastMap = 0.1e-3;  // m
  static constexpr double kMostMap = 0.1;

  std::array<bool, 3> open{true, true, true};
  bool plots = true;
  bool hidden = false;  // all of them
  bool help = false;
  std::uint32_t hand = 0;    // whose numbers are shown
  bool map = false;          // the organ is coloured by its displacement
  double map_range = 10e-3;  // m
  bool close_up = false;     // of the view of the beginning
  FileChooser files;
};

/// What a viewer shows in one frame; valid for that frame.
struct ViewerModel {
  const RecordedView& view;
  const Overview& overview;
  const Playback& playback;
  std::uint64_t tick = 0;  // of the picture and of all numbers
  const ActiveParameters& active_parameters;
  const std::vector<std::deque<haptics::TickRow>>& rows;  // a hand each, of the time plotted
  double from = 0.0;                                      // s, of the time plotted
  double to = 8.0;
  bool there = true;   // the picture shows where playback is
  bool still = false;  // it is of full quality, as a file's
};

/// What the user has asked of a viewer in one frame, by panel or key.
struct ViewerCommands {
  std::optional<std::uint64_t> go_to;  // tick
  bool play = false;                   // or stop
  std::int64_t ticks = 0;              // steps
  std::int64_t pictures = 0;
  double seconds = 0.0;
  std::optional<std::size_t> speed;
  std::optional<std::uint32_t> hand;
  std::optional<std::string> open;  // another recording
  bool home = false;                // the camera
  bool save_window = false;
  bool save_picture = false;
  bool full_screen = false;
  bool leave = false;
};

/// How a viewer's window is shared out.
struct ViewerLayout {
  Rectangle picture;
  Rectangle left;      // panels; width 0: not seen
  Rectangle timeline;  // height 0: not seen
  Rectangle plots;
};

/// [any] @param scale of all things. A window too small for all has the picture alone.
[[nodiscard]] ViewerLayout lay_out(float width, float height, float scale, const ViewerState& state);

// Each draws one part (between ImGui's NewFrame and Render) and notes what is asked for.
void draw_viewer_panels(const Rectangle& place, const ViewerModel& seen, ViewerState& state,
                        ViewerCommands& commands);
void draw_timeline(const Rectangle& place, const ViewerModel& seen, const ViewerState& state,
                   ViewerCommands& commands);
void draw_viewer_help(ViewerState& state);
/// The colours of the displacement map, at the picture's upper right corner below `top`.
void draw_map_scale(const Rectangle& picture, float top, double range);

}  // namespace palpate::app
