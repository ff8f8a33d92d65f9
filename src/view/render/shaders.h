#pragma once
#include <string>

#include "palpate/offscreen.h"

/// GLSL 3.30 sources of the picture. Lengths in metres, colours linear until the last line.
namespace palpate::render::shaders {

[[nodiscard]] std::string scene_vertex(Quality quality);
[[nodiscard]] std::string place_vertex();  // only where vertices are
[[nodiscard]] std::string fullscreen_vertex();
[[nodiscard]] std::string depth_fragment();         // depth alone
[[nodiscard]] std::string moments_fragment();       // depth and its square, for soft shadows
[[nodiscard]] std::string soften_fragment();        // evens those out along one axis
[[nodiscard]] std::string occlusion_fragment();     // how much of the sky nearby surfaces hide, and the depth
[[nodiscard]] std::string blur_fragment();          // evens that out, not across depth steps
[[nodiscard]] std::string smooth_edges_fragment();  // of a finished picture
[[nodiscard]] std::string copy_fragment();          // of a picture of the same size
[[nodiscard]] std::string background_fragment();
[[nodiscard]] std::string tissue_fragment(Quality quality);
[[nodiscard]] std::string steel_fragment(Quality quality);

}  // namespace palpate::render::shaders
