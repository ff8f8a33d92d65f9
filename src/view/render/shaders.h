#pragma once
#include <string>

#include "palpate/offscreen.h"

/// GLSL 3.30 sources. Lengths in metres; colours are linear until the last step.
namespace palpate::render::shaders {

#ifdef __EMSCRIPTEN__
inline const char* const kVersion =
    "#version 300 es\n"
    "precision highp float;\nprecision highp int;\n"
    "precision highp sampler2D;\nprecision highp sampler2DShadow;\n";
#else
inline const char* const kVersion = "#version 330 core\n";
#endif

// Filmic tone curve (Narkowicz 2015), sRGB transfer function and a dither of one step against banding.
inline const char* const kFinish = R"(
float dither_value(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
vec3 encoded(vec3 x) {
  x = sqrt(x);
  return x * (1.145 - 0.145 * x);  // the sRGB transfer to 0.4 %, but for the darkest
}
vec3 finish(vec3 colour) {
  vec3 x = max(colour, vec3(0.0));
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  return encoded(x) + (dither_value(gl_FragCoord.xy) - 0.5) / 255.0;
}
)";

// The studio's wall, at a place of the picture from 0 to 1.
inline const char* const kWall = R"(
vec3 wall(vec2 uv) {
  vec2 d = (uv - vec2(0.5, 0.56)) * vec2(1.25, 1.1);
  return mix(vec3(0.300, 0.325, 0.350), vec3(0.060, 0.068, 0.078), smoothstep(0.0, 0.95, length(d)));
}
)";

// The studio lamps, fixed to the camera: key, fill, rim and ambient light.
inline const char* const kLamps = R"(
uniform vec3 eye;
uniform vec3 rig_right;
uniform vec3 rig_up;
uniform vec3 rig_back;
uniform vec3 key;
uniform vec3 fill;
uniform vec3 rim;
uniform mat4 light_projection;

uniform float lamps;  // 1; 0: switched off, only the light from everywhere is left
#define kKeyColour (lamps * vec3(1.95, 1.88, 1.78))
#define kFillColour (lamps * vec3(0.36, 0.41, 0.48))
#define kRimColour (lamps * vec3(0.70, 0.74, 0.80))
// Light travels under the surface: farthest in the colours that the tissue absorbs least. 0 to 1 per colour.
vec3 spread_of(vec3 albedo) {
  return clamp(2.0 * albedo / max(max(albedo.r, albedo.g), max(albedo.b, 1e-4)) - 1.0, 0.0, 1.0);
}
vec3 irradiance(vec3 n) {
  float t = dot(n, rig_up) * 0.5 + 0.5;
  return mix(vec3(0.13, 0.12, 0.12), vec3(0.36, 0.39, 0.43), t);
}
vec3 wrapped(vec3 n, vec3 l, vec3 spread) {
  vec3 wrap = 0.10 + 0.10 * spread;
  return clamp((dot(n, l) + wrap) / (1.0 + wrap), 0.0, 1.0);
}
)";

// Colours of maps.
inline const char* const kMapped = R"(
// Dark blue over green to yellow, about as light as it is large (after Matplotlib's viridis).
vec3 mapped(float t) {
  const vec3 c0 = vec3(0.063, 0.0006, 0.089);
  vec3 low = mix(c0, vec3(0.026, 0.162, 0.262), smoothstep(0.0, 0.35, t));
  vec3 mid = mix(low, vec3(0.036, 0.370, 0.217), smoothstep(0.3, 0.65, t));
  return mix(mid, vec3(0.980, 0.800, 0.019), smoothstep(0.6, 1.0, t));
}
)";

/// Whether tissue is drawn with a map of values and marks. Its shaders are separate, because they take
/// longer.
enum class Annotated : bool { kNo, kYes };

[[nodiscard]] std::string scene_vertex(Quality quality, Annotated annotated);
[[nodiscard]] std::string position_vertex();  // position only
[[nodiscard]] std::string fullscreen_vertex();
[[nodiscard]] std::string depth_fragment();       // depth only
[[nodiscard]] std::string cover_fragment();       // 1 and the depth of what casts a soft shadow
[[nodiscard]] std::string blur_cover_fragment();  // blurs these along one axis
[[nodiscard]] std::string occlusion_fragment();   // ambient occlusion, and the depth
[[nodiscard]] std::string blur_fragment();        // blurs the occlusion, but not across depth steps
[[nodiscard]] std::string antialias_fragment();   // antialiasing of a finished picture
[[nodiscard]] std::string copy_fragment();        // copies a picture of the same size
[[nodiscard]] std::string background_fragment();
[[nodiscard]] std::string tissue_fragment(Quality quality, Annotated annotated);
[[nodiscard]] std::string steel_fragment(Quality quality);
[[nodiscard]] std::string drape_vertex();
[[nodiscard]] std::string drape_fragment();

}  // namespace palpate::render::shaders
