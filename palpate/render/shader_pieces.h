#pragma once

/// Pieces of GLSL that several shaders of the picture share. Internal to render.
namespace palpate::render::shaders {

inline const char* const kVersion = "#version 330 core\n";

// Film-like tone curve (Narkowicz 2015), sRGB transfer, and a dither of one step against bands.
inline const char* const kFinish = R"(
float dither_value(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
vec3 finish(vec3 colour) {
  vec3 x = max(colour, vec3(0.0));
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  x = mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), x));
  return x + (dither_value(gl_FragCoord.xy) - 0.5) / 255.0;
}
)";

}  // namespace palpate::render::shaders
