#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "palpate/offscreen.h"

#include "app/window/resolution_choice.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// The picture of organ and tools in a window. It lowers its quality, then its resolution, when frames take
/// too long. An unchanged picture is not drawn again. All members: [setup], the thread whose OpenGL context
/// is current.
class LivePicture final {
 public:
  /// Draws this subject from now on.
  void take(const render::Subject& subject);
  /// Requests a new picture although the camera has not moved.
  void refresh() noexcept { stale_ = true; }
  /// Discards the frame times measured so far.
  void forget_times() noexcept { resolution_.forget_times(); }
  /// Draws every pixel at full quality from now on, whatever a frame takes.
  void hold_full_quality();
  /// Colours the organ by its displacement, from 0 to `range` [m]; 0: its own colours.
  void set_map_range(double range);
  /// Shows or hides the drape under the organ.
  void show_drape(bool shown);
  /// Replaces the inclusions that the picture shows; organ frame.
  void show_inclusions(std::vector<model::Inclusion> inclusions);

  /// Colours the organ by values at points of its rest surface; the same points as before only change their
  /// values. No points: its own colours.
  void show_values(const std::vector<Vec3>& points_S, std::vector<float> values, double low, double high);
  /// Changes what holds the organ (OffscreenRenderer::set_support()).
  void set_support(std::optional<geometry::Support> support);
  [[nodiscard]] render::ResponseState response() const noexcept;
  /// Replaces the marks on the surface.
  void show_marks(const std::vector<render::SurfaceMark>& marks);

  /// Draws the picture if it has changed, and copies it to `place` in the window.
  void show(const haptics::Snapshot& snapshot, const render::Camera& camera, const Rectangle& place,
            const Viewport& viewport);
  /// Adapts quality and resolution. Call once per frame with the time of the whole frame [s].
  void adapt(double frame_time);
  /// Adapts before the run starts: judges fewer frames than adapt(), and draws every frame again. @return
  /// whether frames stay within their time
  [[nodiscard]] bool settle(double frame_time);
  /// Lowers the resolution because memory for pictures ran out. @return false at the lowest resolution
  bool shrink();
  /// Releases the picture without any OpenGL call, after the display was lost.
  void abandon() noexcept { (void)renderer_.release(); }

 private:
  void fit(int width, int height);
  bool follow(double frame_time, std::size_t judged);

  std::unique_ptr<render::OffscreenRenderer> renderer_;
  Display::Size drawn_size_;  // size of the renderer's pictures
  ResolutionChoice resolution_;
  bool held_ = false;
  double map_range_ = 0.0;  // m
  bool drape_ = false;
  std::size_t values_ = 0;  // number of points of the values that are shown
  double low_ = 0.0;
  double high_ = 0.0;
  bool stale_ = true;  // the renderer's picture is out of date
  bool drew_ = false;  // a picture was drawn since the last judged frame
  render::Camera drawn_camera_;
};

/// Rectangle of the window in pixels. As in OpenGL, y counts upwards from the lower edge.
struct PixelRectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};
[[nodiscard]] PixelRectangle in_pixels(const Rectangle& place, const Viewport& viewport);

}  // namespace palpate::app
