#pragma once
#include <cstddef>
#include <memory>

#include "palpate/offscreen.h"

#include "app/window/resolution_choice.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// The picture of organ and tools in a window. Its quality and then its resolution follow what the machine
/// can draw in time; a picture that would be the same is not drawn again. All members: [setup], the thread
/// whose OpenGL context is current.
class LivePicture final {
 public:
  /// From here on pictures of this subject.
  void take(const render::Subject& subject);
  /// What is to be shown has changed although the camera has not.
  void refresh() noexcept { stale_ = true; }
  /// Forgets how long pictures took.
  void forget_times() noexcept { resolution_.forget_times(); }
  /// From here on every pixel is drawn at full quality, however long a frame takes.
  void hold_full_quality();
  /// Colours the organ by how far it has moved, up to `range` [m]; 0: its own colours.
  void set_map_range(double range);

  /// Draws what is to be drawn and puts it into its place.
  void show(const haptics::Snapshot& snapshot, const render::Camera& camera, const Rectangle& place,
            const Viewport& viewport);
  /// Once a frame: how long the whole of it took [s].
  void adapt(double frame_time);
  /// The same before anything moves, after a few frames already; the next one draws again. @return whether
  /// the picture suits the machine
  [[nodiscard]] bool settle(double frame_time);
  /// The memory for pictures ran out: smaller ones. @return whether there are any
  bool shrink();
  /// The display is gone: what was on it is left as it is.
  void abandon() noexcept { (void)renderer_.release(); }

 private:
  void fit(int width, int height);
  bool follow(double frame_time, std::size_t judged);

  std::unique_ptr<render::OffscreenRenderer> renderer_;
  Display::Size drawn_size_;  // of the renderer's pictures
  ResolutionChoice resolution_;
  bool held_ = false;
  double map_range_ = 0.0;  // m
  bool stale_ = true;       // what the renderer keeps is not what is to be shown
  bool drew_ = false;       // since the last frame that was judged
  render::Camera drawn_camera_;
};

/// [any] Whether two cameras see the same.
[[nodiscard]] bool same(const render::Camera& a, const render::Camera& b);

/// A rectangle of the window in pixels, y up from its lower edge, as OpenGL counts.
struct PixelRectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};
[[nodiscard]] PixelRectangle in_pixels(const Rectangle& place, const Viewport& viewport);

}  // namespace palpate::app
