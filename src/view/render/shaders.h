#pragma once
#include <string>

#include "palpate/offscreen.h"

/// GLSL 3.30 sources. Lengths in metres; colours are linear until the last step.
namespace palpate::render::shaders {

/// Whether tissue is drawn with a map of values and marks. Its shaders are separate, because they take
/// longer.
enum class Annotated : bool { kNo, kYes };

[[nodiscard]] std::string scene_vertex(Quality quality, Annotated annotated);
[[nodiscard]] std::string position_vertex();  // position only
[[nodiscard]] std::string fullscreen_vertex();
[[nodiscard]] std::string depth_fragment();         // depth only
[[nodiscard]] std::string moments_fragment();       // depth and its square, for soft shadows (variance shadow
                                                    // map)
[[nodiscard]] std::string blur_moments_fragment();  // blurs the moments along one axis
[[nodiscard]] std::string occlusion_fragment();     // ambient occlusion, and the depth
[[nodiscard]] std::string blur_fragment();          // blurs the occlusion, but not across depth steps
[[nodiscard]] std::string antialias_fragment();     // antialiasing of a finished picture
[[nodiscard]] std::string copy_fragment();          // copies a picture of the same size
[[nodiscard]] std::string background_fragment();
[[nodiscard]] std::string tissue_fragment(Quality quality, Annotated annotated);
[[nodiscard]] std::string steel_fragment(Quality quality);

}  // namespace palpate::render::shaders
