#pragma once
#include <string>

/// GLSL 3.30 sources of the picture. Lengths in metres, colours linear until the last line.
namespace palpate::render::shaders {

[[nodiscard]] std::string scene_vertex();
[[nodiscard]] std::string fullscreen_vertex();
[[nodiscard]] std::string depth_fragment();      // depth alone
[[nodiscard]] std::string occlusion_fragment();  // how much of the sky nearby surfaces hide, and the depth
[[nodiscard]] std::string blur_fragment();       // evens that out, not across depth steps
[[nodiscard]] std::string background_fragment();
[[nodiscard]] std::string tissue_fragment();
[[nodiscard]] std::string steel_fragment();

}  // namespace palpate::render::shaders
