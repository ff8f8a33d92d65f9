#pragma once
#include <string>

#include "palpate/tick_observer.h"

#include "app/window/mark_shapes.h"
#include "app/window/orbit_camera.h"
#include "app/window/viewport.h"

namespace palpate::app {

/// [setup] Draws the marks over the picture, between ImGui's NewFrame and Render.
void draw_marks(const Rectangle& picture, const OrbitCamera& camera, const haptics::Snapshot& shown,
                const PictureMarks& marks, NeedleMarks* needle);

/// [setup] Draws a line of text on a plate at the lower edge of the picture, in its middle.
void draw_hint(const Rectangle& picture, const std::string& text);

}  // namespace palpate::app
