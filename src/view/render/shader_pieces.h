#pragma once

/// GLSL code shared by several shaders. Internal to render.
namespace palpate::render::shaders {

inline const char* const kVersion = "#version 330 core\n";

// Filmic tone curve (Narkowicz 2015), sRGB transfer function and a dither of one step against banding.
inline const char* const kFinish = R"(
float dither_value(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
vec3 finish(vec3 colour) {
  vec3 x = max(colour, vec3(0.0));
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  x = sqrt(x);
  x *= 1.145 - 0.145 * x;  // the sRGB transfer to 0.4 %, but for the darkest
  return x + (dither_value(gl_FragCoord.xy) - 0.5) / 255.0;
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
uniform float shadow_lift;  // m

uniform float lamps;  // 1; 0: switched off, only the light from everywhere is left
#define kKeyColour (lamps * vec3(1.95, 1.88, 1.78))
#define kFillColour (lamps * vec3(0.36, 0.41, 0.48))
#define kRimColour (lamps * vec3(0.70, 0.74, 0.80))
const vec3 kWrap = vec3(0.20, 0.11, 0.09);  // red light travels farthest under the surface

vec3 irradiance(vec3 n) {
  float t = dot(n, rig_up) * 0.5 + 0.5;
  return mix(vec3(0.13, 0.12, 0.12), vec3(0.36, 0.39, 0.43), t);
}
vec3 wrapped(vec3 n, vec3 l) { return clamp((dot(n, l) + kWrap) / (1.0 + kWrap), 0.0, 1.0); }
)";

}  // namespace palpate::render::shaders
