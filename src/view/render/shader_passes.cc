// Passes other than the materials: shadows, occlusion, antialiasing, background.
#include "view/render/shaders.h"

namespace palpate::render::shaders {

std::string scene_vertex(Quality quality, Annotated annotated) {
  return std::string(kVersion) + (quality == Quality::kFull ? "#define FULL\n" : "") +
         (annotated == Annotated::kYes ? "#define ANNOTATED\n" : "") + kLamps + kMapped + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float moved;
layout(location = 3) in vec3 rest_position;
layout(location = 4) in vec4 pattern_colour;
layout(location = 5) in vec3 pattern_vessel;
layout(location = 6) in vec4 pattern_light;
#ifdef ANNOTATED
layout(location = 7) in vec2 map_value;  // fraction of the range; known
uniform float values_shown;              // 1: map_value gives the colours
out vec2 map_at;                         // interpolated only from vertices whose value is known
#endif
uniform mat4 projection;
uniform mat4 model;
uniform float map_range;  // m of displacement that the colour map spans; 0: no map
out vec3 p_W;
out vec3 n_W;
out vec3 rest;
out vec4 colour;
out vec4 vessel;
out vec2 beside;  // radii to the side of a vessel's line; share of the vessel
out float sky_at_rest;
#ifndef FULL
out vec3 in_shadow_map;
out vec3 other_light;  // all but the key light, over the tissue's colour
#endif

void main() {
  vec4 placed = model * vec4(position, 1.0);
  p_W = placed.xyz;
  n_W = mat3(model) * normal;
  rest = rest_position;
  colour = vec4(pattern_colour.rgb * pattern_colour.rgb, pattern_colour.a);
  vessel = vec4(pattern_vessel, pattern_light.y);
  beside = vec2((pattern_light.z * 2.0 - 1.0) * 3.0, pattern_light.w);
  if (map_range > 0.0) {
    colour = vec4(0.8 * mapped(clamp(abs(moved) / map_range, 0.0, 1.0)), 0.0);
    vessel.w = 0.0;
    beside.y = 0.0;
  }
#ifdef ANNOTATED
  map_at = values_shown * vec2(map_value.x * map_value.y, map_value.y);
  if (values_shown > 0.0)
    colour.rgb = mix(colour.rgb, vec3(dot(colour.rgb, vec3(0.2126, 0.7152, 0.0722))), 0.35);
#endif
  // A dent's own walls hide the sky from it.
  sky_at_rest = pattern_light.x * (1.0 - 0.5 * smoothstep(0.001, 0.014, -moved));
#ifndef FULL
  in_shadow_map = (light_projection * vec4(p_W, 1.0)).xyz * 0.5 + 0.5;
  vec3 tinted_sky = mix(vec3(sky_at_rest), vec3(1.0), 0.35 * colour.rgb * (1.0 - sky_at_rest));
  vec3 spread = spread_of(colour.rgb);
  other_light = (kFillColour * wrapped(n_W, fill, spread) + 0.5 * kRimColour * wrapped(n_W, rim, spread) +
                 irradiance(n_W)) * tinted_sky;
#endif
  gl_Position = projection * placed;
}
)";
}

std::string position_vertex() {
  return std::string(kVersion) + R"(
layout(location = 0) in vec3 position;
uniform mat4 projection;
uniform mat4 model;
void main() {
  gl_Position = projection * (model * vec4(position, 1.0));
#ifdef GL_ES  // it has no depth clamp
  gl_Position.z = clamp(gl_Position.z, -gl_Position.w, gl_Position.w);
#endif
}
)";
}

std::string fullscreen_vertex() {
  return std::string(kVersion) + R"(
out vec2 uv;
void main() {
  uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(uv * 2.0 - 1.0, 1.0, 1.0);  // behind everything
}
)";
}

std::string depth_fragment() { return std::string(kVersion) + "void main() {}\n"; }

std::string cover_fragment() {
  return std::string(kVersion) + R"(
out vec2 cover;
void main() { cover = vec2(1.0, gl_FragCoord.z); }
)";
}

std::string blur_cover_fragment() {
  return std::string(kVersion) + R"(
out vec2 result;
uniform sampler2D source;
uniform ivec2 along;  // one entry
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(source, 0) - 1;
  vec2 sum = 0.22 * texelFetch(source, at, 0).xy;
  for (int i = 1; i <= 3; ++i) {
    float w = 0.21 - 0.04 * float(i);
    sum += w * (texelFetch(source, min(at + i * along, last), 0).xy +
                texelFetch(source, max(at - i * along, ivec2(0)), 0).xy);
  }
  result = sum;
}
)";
}

std::string occlusion_fragment() {
  // Ambient obscurance from the depth buffer (McGuire et al. 2011), 16 samples on a spiral.
  return std::string(kVersion) + kFinish + R"(
in vec2 uv;
out vec2 result;
uniform sampler2D depth_map;
uniform vec2 pixel_size;
uniform vec2 half_view;  // tangents of the half angles of view
uniform float near_plane;
uniform float far_plane;
uniform float radius;    // m

vec3 place(vec2 at) {
  float d = texture(depth_map, at).r;
  float z = near_plane * far_plane / (far_plane - d * (far_plane - near_plane));
  return vec3((at * 2.0 - 1.0) * half_view * z, z);
}
vec3 shorter(vec3 a, vec3 b) { return abs(a.z) < abs(b.z) ? a : b; }
void main() {
  vec3 p = place(uv);
  if (p.z > 0.98 * far_plane) {
    result = vec2(1.0, p.z);
    return;
  }
  vec2 dx = vec2(pixel_size.x, 0.0);
  vec2 dy = vec2(0.0, pixel_size.y);
  vec3 along_x = shorter(place(uv + dx) - p, p - place(uv - dx));
  vec3 along_y = shorter(place(uv + dy) - p, p - place(uv - dy));
  vec3 n = normalize(cross(along_x, along_y));
  if (dot(n, p) > 0.0) n = -n;
  vec2 spread = radius / (2.0 * half_view * p.z);
  float turn = 6.2831853 * dither_value(gl_FragCoord.xy);
  float hidden = 0.0;
  for (int i = 0; i < 16; ++i) {
    float share = (float(i) + 0.5) / 16.0;
    float a = float(i) * 2.3999632 + turn;
    vec3 w = (place(uv + share * spread * vec2(cos(a), sin(a))) - p) / radius;
    float ww = dot(w, w);
    hidden += max(0.0, dot(w, n) - 0.04) / (ww + 0.02) * max(0.0, 1.0 - ww);
  }
  result = vec2(clamp(1.0 - 1.5 * hidden / 16.0, 0.0, 1.0), p.z);
}
)";
}

std::string blur_fragment() {
  return std::string(kVersion) + R"(
in vec2 uv;
out vec2 result;
uniform sampler2D source;
uniform vec2 pixel_size;
void main() {
  vec2 middle = texture(source, uv).xy;
  float sum = 0.0;
  float weights = 0.0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      vec2 other = texture(source, uv + vec2(float(i), float(j)) * pixel_size).xy;
      float w = max(0.0, 1.0 - abs(other.y - middle.y) / (0.01 * middle.y)) + 1e-4;
      sum += w * other.x;
      weights += w;
    }
  }
  result = vec2(sum / weights, middle.y);
}
)";
}

std::string antialias_fragment() {
  // Blends a pixel with its two neighbours across an edge in brightness.
  return std::string(kVersion) + R"(
out vec4 pixel;
uniform sampler2D source;
uniform ivec2 last;  // pixel
float light_of(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 here = texelFetch(source, at, 0).rgb;
  vec3 w = texelFetch(source, ivec2(max(at.x - 1, 0), at.y), 0).rgb;
  vec3 e = texelFetch(source, ivec2(min(at.x + 1, last.x), at.y), 0).rgb;
  vec3 s = texelFetch(source, ivec2(at.x, max(at.y - 1, 0)), 0).rgb;
  vec3 n = texelFetch(source, ivec2(at.x, min(at.y + 1, last.y)), 0).rgb;
  float m = light_of(here);
  float lw = light_of(w);
  float le = light_of(e);
  float ls = light_of(s);
  float ln = light_of(n);
  float across_x = abs(lw - le) + abs(lw + le - 2.0 * m);
  float across_y = abs(ls - ln) + abs(ls + ln - 2.0 * m);
  vec3 pair = across_x > across_y ? w + e : s + n;
  float most = max(across_x, across_y);
  float edge = clamp((most - 0.06) * 5.0, 0.0, 1.0);
  pixel = vec4(mix(here, 0.5 * here + 0.25 * pair, edge), 1.0);
}
)";
}

std::string copy_fragment() {
  return std::string(kVersion) + R"(
out vec4 pixel;
uniform sampler2D source;
void main() { pixel = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }
)";
}

std::string background_fragment() {
  return std::string(kVersion) + kFinish + kWall + R"(
in vec2 uv;
out vec4 pixel;
void main() { pixel = vec4(finish(wall(uv)), 1.0); }
)";
}

}  // namespace palpate::render::shaders
