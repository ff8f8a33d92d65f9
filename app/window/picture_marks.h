#pragma once
#include <string>

#include "palpate/offscreen.h"
#include "palpate/tick_observer.h"

#include "app/window/orbit_camera.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// Which marks are drawn over the picture.
struct PictureMarks {
  bool force = true;  // an arrow at each contact
  bool scale = true;  // a bar of known length
  bool axes = true;   // directions of the world's axes
};

/// Length of the force arrow [m per N].
inline constexpr double kArrowLength = 0.1;

/// [any] Length of a scale bar: 1, 2 or 5 times a power of ten, the longest that is at most `longest` [m].
[[nodiscard]] double scale_bar_length(double longest);

/// [setup] Draws the marks over the picture, between ImGui's NewFrame and Render. The bar is right at the
/// distance of the view's centre.
void draw_marks(const Rectangle& picture, const OrbitCamera& camera, const haptics::Snapshot& shown,
                const PictureMarks& marks);

/// [setup] Draws a line of text on a plate at the lower edge of the picture, in its middle.
void draw_hint(const Rectangle& picture, const std::string& text);

/// [any] Whether tools and contacts are inside the picture, not at its very edge. Tools far from the organ do
/// not count.
[[nodiscard]] bool contacts_in_frame(const haptics::Snapshot& shown, const render::Camera& camera,
                                     double aspect);

}  // namespace palpate::app
