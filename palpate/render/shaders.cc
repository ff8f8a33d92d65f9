#include "palpate/render/shaders.h"

namespace palpate::render::shaders {
namespace {

const char* const kVersion = "#version 330 core\n";

// Film-like tone curve (Narkowicz 2015), sRGB transfer, and a dither of one step against bands.
const char* const kFinish = R"(
float dither_value(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
vec3 finish(vec3 colour) {
  vec3 x = max(colour, vec3(0.0));
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  x = mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), x));
  return x + (dither_value(gl_FragCoord.xy) - 0.5) / 255.0;
}
)";

// Smooth noise of a point: value in -1..1 and its gradient, quintic between hashed lattice values.
const char* const kNoise = R"(
float lattice(ivec3 c) {
  uint h = uint(c.x) * 374761393u + uint(c.y) * 668265263u + uint(c.z) * 2147483647u;
  h = (h ^ (h >> 13)) * 1274126177u;
  h ^= h >> 16;
  return float(h & 0xffffffu) / 8388607.5 - 1.0;
}
vec4 noise(vec3 p) {
  vec3 cell = floor(p);
  ivec3 c = ivec3(cell);
  vec3 f = p - cell;
  vec3 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  vec3 ds = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  vec4 low = vec4(lattice(c), lattice(c + ivec3(1, 0, 0)), lattice(c + ivec3(0, 1, 0)),
                  lattice(c + ivec3(1, 1, 0)));
  vec4 high = vec4(lattice(c + ivec3(0, 0, 1)), lattice(c + ivec3(1, 0, 1)), lattice(c + ivec3(0, 1, 1)),
                   lattice(c + ivec3(1, 1, 1)));
  vec4 mid = mix(low, high, s.z);
  vec4 rise = high - low;
  vec2 xs = mix(mid.xz, mid.yw, s.x);
  float value = mix(xs.x, xs.y, s.y);
  float dx = mix(mid.y - mid.x, mid.w - mid.z, s.y);
  float dy = xs.y - xs.x;
  vec2 zs = mix(rise.xz, rise.yw, s.x);
  float dz = mix(zs.x, zs.y, s.y);
  return vec4(value, vec3(dx, dy, dz) * ds);
}
)";

// The studio: camera-fixed key, fill and rim lights and what a mirror would see.
const char* const kStudio = R"(
in vec3 p_W;
in vec3 n_W;
in vec3 rest;
out vec4 pixel;
uniform vec3 eye;
uniform vec3 rig_right;
uniform vec3 rig_up;
uniform vec3 rig_back;
uniform vec3 key;
uniform vec3 fill;
uniform vec3 rim;
uniform mat4 light_projection;
uniform float shadow_texel;    // m
uniform float shadow_lift;     // m
uniform float shadow_softness; // of the map's width
uniform sampler2DShadow shadow_map;
uniform sampler2D occlusion_map;
uniform vec2 pixel_size;

const vec3 kKeyColour = vec3(1.95, 1.88, 1.78);
const vec3 kFillColour = vec3(0.36, 0.41, 0.48);
const vec3 kRimColour = vec3(0.70, 0.74, 0.80);

float key_visible(vec3 n) {
  // Lifted by more than the penumbra sees of a bent surface, so that it does not shade itself.
  vec3 p = p_W + n * (2.5 * shadow_texel + shadow_lift) + key * shadow_texel;
  vec3 q = (light_projection * vec4(p, 1.0)).xyz * 0.5 + 0.5;
  float turn = 6.2831853 * dither_value(gl_FragCoord.xy);
  vec2 arm = shadow_softness * vec2(cos(turn), sin(turn));
  const mat2 kGoldenTurn = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
  float sum = 0.0;
  for (int i = 0; i < 16; ++i) {
    sum += texture(shadow_map, vec3(q.xy + sqrt((float(i) + 0.5) / 16.0) * arm, q.z - 0.0006));
    arm = kGoldenTurn * arm;
  }
  return sum / 16.0;
}

float sky_visible() {
  float depth = 1.0 / gl_FragCoord.w;
  vec2 at = gl_FragCoord.xy * pixel_size;
  vec2 step_size = pixel_size * 1.5;
  float sum = 0.0;
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 o = vec2(float(i & 1) - 0.5, float(i >> 1) - 0.5) * step_size;
    vec2 sample_value = texture(occlusion_map, at + o).xy;
    float w = 1e-3 + max(0.0, 1.0 - abs(sample_value.y - depth) / (0.006 * depth));
    sum += w * sample_value.x;
    weights += w;
  }
  return sum / weights;
}

vec3 irradiance(vec3 n) {
  float t = dot(n, rig_up) * 0.5 + 0.5;
  return mix(vec3(0.13, 0.12, 0.12), vec3(0.36, 0.39, 0.43), t);
}

vec3 mirror(vec3 d, float roughness) {
  vec3 q = vec3(dot(d, rig_right), dot(d, rig_up), dot(d, rig_back));
  vec3 colour = mix(vec3(0.07, 0.07, 0.075), vec3(0.50, 0.54, 0.60), smoothstep(-0.5, 0.9, q.y));
  float k = dot(d, key);
  float box = smoothstep(cos(0.55 + 0.7 * roughness), cos(0.34 * (1.0 - roughness)), k);
  colour += vec3(0.30, 0.31, 0.33) * smoothstep(-0.1, 1.0, q.z);
  colour += vec3(1.0, 0.97, 0.93) * box * mix(2.2, 0.9, roughness);
  float strip = smoothstep(0.62 - 0.4 * roughness, 0.95, abs(q.x)) * smoothstep(-0.7, 0.2, q.y);
  colour += vec3(0.75, 0.82, 0.92) * strip * mix(0.9, 0.35, roughness);
  return colour;
}

// Microfacet highlight (GGX, Schlick's Fresnel, Hammon's visibility), times N.L.
float highlight(vec3 n, vec3 v, vec3 l, float roughness) {
  float nl = dot(n, l);
  if (nl <= 0.0) return 0.0;
  vec3 h = normalize(v + l);
  float a = roughness * roughness;
  float nv = max(dot(n, v), 1e-3);
  float nh = max(dot(n, h), 0.0);
  float d = nh * nh * (a * a - 1.0) + 1.0;
  float visible = 0.5 / mix(2.0 * nl * nv, nl + nv, a);
  return nl * visible * a * a / (3.14159265 * d * d);
}
float soft_peak(float x) { return x / (1.0 + 1.8 * x); }  // a film of moisture never glares
float fresnel(float f0, float cosine) { return f0 + (1.0 - f0) * pow(1.0 - clamp(cosine, 0.0, 1.0), 5.0); }
)";

const char* const kTissue = R"(
uniform vec3 base_colour;
uniform vec3 mottle_colour;
uniform vec3 vessel_colour;
uniform vec3 fat_colour;
uniform float vessel_share;
uniform float fat_share;
uniform float mottle_scale;
uniform float vessel_scale;

const mat3 kTurn = mat3(0.36, 0.48, -0.80, -0.80, 0.60, 0.00, 0.48, 0.64, 0.60);

vec3 albedo_at(vec3 s, out float fat) {
  s = kTurn * s;  // so that no pattern follows the mesh's axes
  vec3 bend = 0.55 * noise(kTurn * s * vessel_scale * 1.7).yzw;
  float patches = 0.62 * noise(s * mottle_scale * 0.35).x + 0.38 * noise(s * mottle_scale * 1.7 + 9.0).x;
  vec3 colour = mix(base_colour, mottle_colour, smoothstep(-0.45, 0.45, patches));
  float pads = noise(s * vessel_scale * 0.9 + 71.0 + 0.25 * bend).x + 0.35 * patches;
  fat = fat_share * smoothstep(0.22, 0.62, pads);
  colour = mix(colour, fat_colour, fat);
  float wide = noise(s * vessel_scale + 0.30 * bend + 5.0).x;
  float narrow = noise(kTurn * s * vessel_scale * 2.3 + 0.45 * bend + 83.0).x;
  float reach = smoothstep(-0.30, 0.40, patches + 0.5 * pads);
  float lines = 0.80 * (0.35 + 0.65 * reach) * (1.0 - smoothstep(0.008, 0.030 + 0.060 * reach, abs(wide))) +
                0.42 * (1.0 - reach * 0.6) * (1.0 - smoothstep(0.008, 0.055, abs(narrow)));
  return mix(colour, vessel_colour, clamp(lines, 0.0, 1.0) * vessel_share);
}

void main() {
  vec3 n = normalize(n_W);
  vec3 v = normalize(eye - p_W);
  float fat;
  vec3 albedo = albedo_at(rest, fat);
  float footprint = max(length(dFdx(rest)), length(dFdy(rest)));
  float facing = clamp(dot(n, v), 0.0, 1.0);
  vec3 rough_slope = noise(rest * 420.0).yzw * 0.036 * clamp(1.5 - footprint * 840.0, 0.0, 1.0) +
                     noise(rest * 1150.0).yzw * 0.024 * clamp(1.5 - footprint * 2300.0, 0.0, 1.0);
  rough_slope *= smoothstep(0.0, 0.5, facing);  // seen flat, bumps hide one another
  vec3 bumped = normalize(n - (rough_slope - n * dot(rough_slope, n)));
  vec3 diffuse_n = normalize(mix(n, bumped, 0.5));

  float lit = key_visible(n);
  float sky = sky_visible();
  vec3 wrap = vec3(0.20, 0.11, 0.09);  // red light travels farthest under the surface
  vec3 key_share = clamp((dot(diffuse_n, key) + wrap) / (1.0 + wrap), 0.0, 1.0);
  vec3 soft_lit = vec3(mix(lit, sqrt(lit), 0.5), lit, lit);
  vec3 fill_share = clamp((dot(diffuse_n, fill) + wrap) / (1.0 + wrap), 0.0, 1.0);
  vec3 rim_share = clamp((dot(diffuse_n, rim) + wrap) / (1.0 + wrap), 0.0, 1.0);
  vec3 tinted_sky = mix(vec3(sky), vec3(1.0), 0.35 * albedo * (1.0 - sky));  // light between tissue walls
  vec3 light = kKeyColour * key_share * soft_lit * mix(1.0, sky, 0.35) +
               (kFillColour * fill_share + 0.5 * kRimColour * rim_share + irradiance(diffuse_n)) * tinted_sky;
  vec3 colour = albedo * light * 0.47;

  float gloss = mix(0.27, 0.33, fat);
  float wet = 0.55 * highlight(bumped, v, key, 0.42) + 0.45 * highlight(bumped, v, key, gloss);
  colour += kKeyColour * lit * soft_peak(wet * fresnel(0.030, dot(normalize(v + key), v)));
  colour += kRimColour * sky * soft_peak(highlight(bumped, v, rim, 0.40) * fresnel(0.030, dot(normalize(v + rim), v)));
  colour += kFillColour * sky * highlight(bumped, v, fill, 0.36) * 0.04;
  // Tissue is rough enough that its mirror image fades before the edge (not the full Fresnel reflection).
  float coat = 0.028 + 0.22 * pow(1.0 - facing, 4.0);
  colour += mirror(reflect(-v, bumped), 0.4) * coat * 0.8 * sky * mix(0.55, 1.0, lit);
  pixel = vec4(finish(colour), 1.0);
}
)";

const char* const kSteel = R"(
void main() {
  vec3 n = normalize(n_W);
  vec3 v = normalize(eye - p_W);
  // Brushed along z of the handle frame: fine streaks, long in z.
  vec3 s = rest * vec3(5200.0, 5200.0, 180.0);
  float footprint = max(length(dFdx(s.xy)), length(dFdy(s.xy)));
  vec4 streak = noise(s) * clamp(1.4 - 0.7 * footprint, 0.0, 1.0);
  vec3 slope = vec3(streak.yz, 0.0) * 0.02;
  n = normalize(n - (slope - n * dot(slope, n)));
  float roughness = 0.38 + 0.05 * streak.x;
  vec3 metal = vec3(0.66, 0.655, 0.645) * (1.0 + 0.05 * streak.x);

  float lit = key_visible(normalize(n_W));
  float sky = sky_visible();
  float nv = max(dot(n, v), 0.0);
  vec3 f = metal + (1.0 - metal) * pow(1.0 - nv, 5.0);
  vec3 colour = mirror(reflect(-v, n), roughness) * f * sky * mix(0.75, 1.0, lit);
  colour += kKeyColour * 0.55 * lit * highlight(n, v, key, roughness) * f;
  colour += kRimColour * 0.5 * highlight(n, v, rim, roughness) * f * sky;
  colour += kFillColour * 0.5 * highlight(n, v, fill, 0.45) * f * sky;
  colour += metal * 0.10 * (irradiance(n) * sky + kKeyColour * 0.5 * lit * max(dot(n, key), 0.0));
  pixel = vec4(finish(colour * 0.92), 1.0);
}
)";

}  // namespace

std::string scene_vertex() {
  return std::string(kVersion) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest_position;
uniform mat4 projection;
out vec3 p_W;
out vec3 n_W;
out vec3 rest;
void main() {
  p_W = position;
  n_W = normal;
  rest = rest_position;
  gl_Position = projection * vec4(position, 1.0);
}
)";
}

std::string fullscreen_vertex() {
  return std::string(kVersion) + R"(
out vec2 uv;
void main() {
  uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0);
}
)";
}

std::string depth_fragment() { return std::string(kVersion) + "void main() {}\n"; }

std::string occlusion_fragment() {
  // Ambient obscurance from the depth picture (McGuire et al. 2011), 16 samples on a spiral.
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

std::string background_fragment() {
  return std::string(kVersion) + kFinish + R"(
in vec2 uv;
out vec4 pixel;
void main() {
  vec2 d = (uv - vec2(0.5, 0.56)) * vec2(1.25, 1.1);
  float fall = smoothstep(0.0, 0.95, length(d));
  vec3 colour = mix(vec3(0.300, 0.325, 0.350), vec3(0.060, 0.068, 0.078), fall);
  pixel = vec4(finish(colour), 1.0);
}
)";
}

std::string tissue_fragment() { return std::string(kVersion) + kFinish + kNoise + kStudio + kTissue; }

std::string steel_fragment() { return std::string(kVersion) + kFinish + kNoise + kStudio + kSteel; }

}  // namespace palpate::render::shaders
