#pragma once
#include <string>

#include "palpate/offscreen.h"

#include "bench/measure/account.h"

namespace palpate::bench {

/// [setup] Renders a built-in scene in contact along its own path, 1280 x 720 pixels, 60 pictures per second,
/// as the window does with a still camera. Measures CPU time of deformation and upload, and wall time and CPU
/// time of whole frames; in turns with these, the CPU time of full redraws, and of frames while the view
/// turns with and without a drape. Contacts are computed on the scene's own organ.
/// @param organ_triangles triangles of the displayed organ; 0: as built in. @throws std::runtime_error
/// without OpenGL.
[[nodiscard]] PictureAccount time_pictures(const std::string& task, std::size_t organ_triangles,
                                           render::Quality quality);

}  // namespace palpate::bench
