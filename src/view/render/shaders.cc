// The materials: tissue and steel in studio lighting, and the surgical drape under the organ.
#include "view/render/shaders.h"

namespace palpate::render::shaders {
namespace {

// Smooth noise at a point: value in -1..1 and gradient; quintic interpolation of hashed lattice values.
const char* const kNoise = R"(
// Hashed values -1..1 at the eight corners of a cell; x first, then y; low and high in z.
vec4 hashed(uvec4 h) {
  h = (h ^ (h >> 13u)) * 1274126177u;
  h ^= h >> 16u;
  return vec4(h & 0xffffffu) * (1.0 / 8388607.5) - 1.0;
}
void corners(ivec3 c, out vec4 low, out vec4 high) {
  uint x = uint(c.x) * 374761393u;
  uint y = uint(c.y) * 668265263u + uint(c.z) * 2147483647u;
  uvec4 h = uvec4(x + y) + uvec4(0u, 374761393u, 668265263u, 1043026656u);
  low = hashed(h);
  high = hashed(h + 2147483647u);
}
vec4 noise(vec3 p) {
  vec3 cell = floor(p);
  ivec3 c = ivec3(cell);
  vec3 f = p - cell;
  vec3 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  vec3 ds = 30.0 * f * f * (f * (f - 2.0) + 1.0);
  vec4 low;
  vec4 high;
  corners(c, low, high);
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

const char* const kNoiseValue = R"(
float noise_value(vec3 p) {
  vec3 cell = floor(p);
  ivec3 c = ivec3(cell);
  vec3 f = p - cell;
  vec3 s = f * f * (3.0 - 2.0 * f);
  vec4 low;
  vec4 high;
  corners(c, low, high);
  vec4 mid = mix(low, high, s.z);
  vec2 xs = mix(mid.xz, mid.yw, s.x);
  return mix(xs.x, xs.y, s.y);
}
)";

// The studio: camera-fixed key, fill and rim lights and the environment for reflections.
const char* const kStudio = R"(
in vec3 p_W;
in vec3 n_W;
in vec3 rest;
in vec4 colour;
in vec4 vessel;
in vec2 beside;
in float sky_at_rest;
out vec4 pixel;
#ifdef FULL
uniform float shadow_softness;  // of the map's width
uniform sampler2DShadow shadow_map;
uniform sampler2D occlusion_map;
#else
in vec3 in_shadow_map;
uniform sampler2D cover_map;
uniform float shadow_depth;  // m, of the map
in vec3 other_light;
#endif
uniform float shadow_reach;  // m, how far the softening reaches across the light
uniform vec2 pixel_size;

#ifdef FULL
// 4 x 4 taps, little farther apart than the map's texels, which are interpolated.
float key_visible(vec3 n) {
  float facing = dot(n, key);
  // What the taps see of a surface that is itself lit lies higher by their reach times the slope to the light.
  // A shift along the normal by their reach clears it on a plane of any slope.
  vec3 p = p_W + n * (shadow_reach * sqrt(max(1.0 - facing * facing, 0.0))) + key * (0.25 * shadow_reach);
  vec3 q = (light_projection * vec4(p, 1.0)).xyz * 0.5 + 0.5;
  const vec4 kTaps = vec4(-0.75, -0.25, 0.25, 0.75);
  const vec4 kWeights = vec4(1.0, 2.0, 2.0, 1.0) / 6.0;
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      vec2 at = q.xy + shadow_softness * vec2(kTaps[i], kTaps[j]);
      vec2 outside = step(vec2(0.5), abs(at - 0.5));  // parts of a large organ outside the map are lit
      sum += kWeights[i] * kWeights[j] * max(texture(shadow_map, vec3(at, q.z)), max(outside.x, outside.y));
    }
  }
  return sum;
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
  return sum / weights * mix(1.0, sky_at_rest, 0.5);
}

#else
// The tools' shadow. The softened map holds how much of the light the tools cover, and that times their mean
// depth. The shadow falls only on what is deeper.
float key_visible(vec3 n) {
  vec2 cover = texture(cover_map, in_shadow_map.xy).xy;
  float behind = (in_shadow_map.z * cover.x - cover.y) * shadow_depth / shadow_reach;  // times the cover
  float facing = dot(n, key);
#ifdef STEEL
  // A tool's own surface is deeper than the mean over the softening's reach by at most that times its slope.
  behind -= cover.x * sqrt(max(1.0 - facing * facing, 0.0)) / max(facing, 0.01);
#endif
  // Surfaces that face away lie in the organ's own shadow, not in the tools'.
  return 1.0 - clamp(4.0 * behind, 0.0, cover.x) * clamp(1.5 + 5.0 * facing, 0.0, 1.0);
}
float sky_visible() { return sky_at_rest; }
#endif

vec3 mirror(vec3 d, float roughness) {
  vec3 q = vec3(dot(d, rig_right), dot(d, rig_up), dot(d, rig_back));
  vec3 colour = mix(vec3(0.07, 0.07, 0.075), vec3(0.50, 0.54, 0.60), smoothstep(-0.5, 0.9, q.y));
  float k = dot(d, key);
  float box = smoothstep(cos(0.55 + 0.7 * roughness), cos(0.34 * (1.0 - roughness)), k);
  colour += vec3(0.30, 0.31, 0.33) * smoothstep(-0.1, 1.0, q.z);
  colour += lamps * vec3(1.0, 0.97, 0.93) * box * mix(2.2, 0.9, roughness);
  float strip = smoothstep(0.62 - 0.4 * roughness, 0.95, abs(q.x)) * smoothstep(-0.7, 0.2, q.y);
  colour += lamps * vec3(0.75, 0.82, 0.92) * strip * mix(0.9, 0.35, roughness);
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
float fresnel(float f0, float cosine) {
  float x = 1.0 - clamp(cosine, 0.0, 1.0);
  return f0 + (1.0 - f0) * x * x * x * x * x;
}
)";

const char* const kTissue = R"(
uniform vec3 vessel_colour;
uniform float vessel_share;

float vessels() {
  float width = vessel.w;
  float lines = 0.0;
#ifndef FAST
  float wide = abs(noise_value(vessel.xyz));
  lines = 0.85 * width * (1.0 - smoothstep(0.25, 1.0, wide / (0.012 + 0.045 * width)));
#endif
#ifdef FULL
  float narrow = abs(noise_value(vessel.zxy * 2.3 + 83.0));
  float fine = width * (1.2 - width);
  lines = max(lines, 1.4 * fine * (1.0 - smoothstep(0.2, 1.0, narrow / (0.012 + 0.05 * width))));
#endif
  return clamp(lines, 0.0, 1.0) * vessel_share;
}
const vec3 kArteryColour = vec3(0.23, 0.018, 0.016);
// The tissue's colour with its vessels.
vec3 with_vessels() {
  float artery = beside.y * (1.0 - smoothstep(0.5, 0.95, abs(beside.x)));
  return mix(mix(colour.rgb, vessel_colour, vessels()), kArteryColour, artery);
}

uniform mat4 model;

#ifdef ANNOTATED
uniform int inclusion_count;
uniform vec3 inclusion_centre[8];  // m, world frame
uniform float inclusion_radius[8];
uniform float inclusion_soft[8];  // 1: softer than the tissue

// The colour of the tissue with the inclusions that the view through this point meets: lit spheres in
// translucent tissue, with soft edges, fainter the deeper they are. The tissue's rest position takes the place
// of the point, so that an inclusion moves with the tissue above it.
vec3 with_inclusions(vec3 albedo, vec3 v) {
  vec3 at = (model * vec4(rest, 1.0)).xyz;
  for (int i = 0; i < inclusion_count; ++i) {
    vec3 to_centre = inclusion_centre[i] - at;
    float along = -dot(to_centre, v);  // depth of the centre behind this point
    vec3 across = -(to_centre + along * v) / inclusion_radius[i];
    float off = dot(across, across);
    if (off >= 1.0 || along <= 0.0) continue;
    float facing = sqrt(1.0 - off);
    float lit = 0.5 + 0.5 * dot(across + facing * v, key);
    float faint = exp(-max(0.0, along - inclusion_radius[i]) / 0.05);
    vec3 tint = mix(vec3(0.80, 0.60, 0.36), vec3(0.10, 0.24, 0.46), inclusion_soft[i]);
    vec3 body = tint * mix(0.10, 1.0, lit * lit);
    albedo = mix(albedo, body, 0.42 * faint * smoothstep(0.0, 0.8, facing));
  }
  return albedo;
}

in vec2 map_at;

// The finished colour, or the map's where values are known: as in the legend, without gloss, slightly darker
// where less light falls.
vec3 with_values(vec3 finished, vec3 light) {
  float known = smoothstep(0.4, 0.6, map_at.y);
  if (known <= 0.0) return finished;
  float shading = mix(0.45, 1.05, clamp(0.45 * dot(light, vec3(0.2126, 0.7152, 0.0722)), 0.0, 1.0));
  return mix(finished, shading * encoded(mapped(map_at.x / map_at.y)), known);
}

uniform int mark_count;
uniform vec3 mark_point[32];  // m, world frame
uniform int mark_kind[32];    // 0 found, 1 false, 2 lump
uniform float mark_radius;    // m
uniform int hole_count;
uniform vec3 hole_point[32];  // m, world frame
uniform float hole_radius[32];  // m
uniform float pixel_length;   // m

// Distance [m] from the lines of a mark, negative inside, at a position relative to its middle in the picture's
// plane: a dot in a ring, a cross, or a larger ring.
float mark_distance(vec2 p, int kind) {
  float half_line = 0.13 * mark_radius;
  if (kind == 1) {
    vec2 q = abs(vec2(p.x + p.y, p.x - p.y)) * 0.70710678;
    return length(vec2(max(max(q.x, q.y) - mark_radius, 0.0), min(q.x, q.y))) - half_line;
  }
  float r = length(p);
  if (kind == 2) return abs(r - 1.5 * mark_radius) - half_line;
  return min(r - 0.42 * mark_radius, abs(r - 0.9 * mark_radius) - half_line);
}

// The finished colour with the marks near this point: white lines with a dark outline, not lit. The tissue's
// rest position takes the place of the point, so that a mark moves with the tissue.
vec3 with_marks(vec3 finished) {
  vec3 at = (model * vec4(rest, 1.0)).xyz;
  for (int i = 0; i < hole_count; ++i) {  // dark, with a softer rim
    float outside = length(at - hole_point[i]) - hole_radius[i];
    float rim = 1.0 - smoothstep(0.0, 1.5 * hole_radius[i], outside);
    finished *= mix(vec3(1.0), vec3(0.72, 0.5, 0.5), rim);
    finished = mix(finished, vec3(0.06, 0.01, 0.01), clamp(0.5 - outside / pixel_length, 0.0, 1.0));
  }
  for (int i = 0; i < mark_count; ++i) {
    vec3 d = at - mark_point[i];
    if (dot(d, d) > 16.0 * mark_radius * mark_radius) continue;
    float outside = mark_distance(vec2(dot(d, rig_right), dot(d, rig_up)), mark_kind[i]);
    float outline = 0.13 * mark_radius;
    finished = mix(finished, vec3(0.03), clamp(0.5 - (outside - outline) / pixel_length, 0.0, 1.0));
    finished = mix(finished, vec3(1.0), clamp(0.5 - outside / pixel_length, 0.0, 1.0));
  }
  return finished;
}
vec3 annotated(vec3 finished, vec3 light) { return with_marks(with_values(finished, light)); }
#else
vec3 with_inclusions(vec3 albedo, vec3 v) { return albedo; }
vec3 annotated(vec3 finished, vec3 light) { return finished; }
#endif

#ifdef FULL
void main() {
  vec3 n = normalize(n_W);
  vec3 v = normalize(eye - p_W);
  vec3 albedo = with_inclusions(with_vessels(), v);
  float fat = colour.a;
  float facing = clamp(dot(n, v), 0.0, 1.0);
  float flat_on = smoothstep(0.0, 0.5, facing);  // seen flat, bumps hide one another
  vec3 slope = vec3(0.0);
  float footprint = max(length(dFdx(rest)), length(dFdy(rest)));
  vec3 waves = noise(rest * 190.0).yzw * 0.030;
  slope = noise(rest * 520.0).yzw * 0.028 * clamp(1.5 - footprint * 1040.0, 0.0, 1.0) +
          noise(rest * 1350.0).yzw * 0.016 * clamp(1.5 - footprint * 2700.0, 0.0, 1.0);
  slope = (slope + waves) * flat_on;
  vec3 wet_slope = waves * flat_on + 0.30 * slope;  // the film of moisture lies smoother than the tissue
  vec3 bumped = normalize(n - (slope - n * dot(slope, n)));
  vec3 wet_n = normalize(n - (wet_slope - n * dot(wet_slope, n)));
  vec3 diffuse_n = normalize(mix(n, bumped, 0.6));

  float lit = key_visible(n);
  float sky = sky_visible();
  vec3 spread = spread_of(albedo);
  vec3 soft_lit = mix(vec3(lit), vec3(sqrt(lit)), 0.5 * spread);
  vec3 tinted_sky = mix(vec3(sky), vec3(1.0), 0.35 * albedo * (1.0 - sky));  // light between tissue walls
  vec3 light = kKeyColour * wrapped(diffuse_n, key, spread) * soft_lit * mix(1.0, sky, 0.45) +
               (kFillColour * wrapped(diffuse_n, fill, spread) +
                0.5 * kRimColour * wrapped(diffuse_n, rim, spread) + irradiance(diffuse_n)) * tinted_sky;
  vec3 shade = albedo * light * 0.47;

  // Two layers: the tissue's own dull gloss, and a thin clear film over it.
  float dull = highlight(bumped, v, key, mix(0.46, 0.52, fat)) * fresnel(0.028, dot(normalize(v + key), v));
  shade += kKeyColour * lit * soft_peak(0.8 * dull);
  float film = fresnel(0.026, facing);
  film = min(film, 0.16);  // a film on rough tissue does not mirror at the edge as glass would
  float wet = highlight(wet_n, v, key, 0.20) * fresnel(0.026, dot(normalize(v + key), v));
  shade += kKeyColour * lit * soft_peak(0.55 * wet);
  shade += mirror(reflect(-v, wet_n), 0.22) * film * 1.25 * sky * mix(0.45, 1.0, lit);
  float back = highlight(wet_n, v, rim, 0.34) * fresnel(0.028, dot(normalize(v + rim), v));
  shade += 0.5 * kRimColour * sky * soft_peak(back);
  pixel = vec4(annotated(finish(shade), light), 1.0);
}
#else
void main() {
  vec3 v = normalize(eye - p_W);
  vec3 albedo = with_inclusions(with_vessels(), v);
  vec3 n = n_W;
#ifndef FAST
  vec3 waves = noise(rest * 260.0).yzw * (0.034 * smoothstep(0.0, 0.5, dot(n, v)));
  n -= waves - n * dot(waves, n);
#endif
  n = normalize(n);
  float lit = key_visible(n);
  float facing = max(dot(n, v), 1e-3);
  vec3 spread = spread_of(albedo);
  vec3 soft_lit = mix(vec3(lit), vec3(sqrt(lit)), 0.5 * spread);
  vec3 light = kKeyColour * wrapped(n, key, spread) * soft_lit * mix(1.0, sky_at_rest, 0.45) + other_light;
  vec3 shade = albedo * light * 0.47;

  // As kFull's, with one normal for both layers.
  vec3 h = normalize(v + key);
  float nl = max(dot(n, key), 0.0);
  float nh = max(dot(n, h), 0.0);
  float hidden = nh * nh * (0.22 * 0.22 - 1.0) + 1.0;
  float shining = nh * nh * (0.06 * 0.06 - 1.0) + 1.0;
  float f = fresnel(0.027, dot(h, v)) * nl * 0.5 / (3.14159265 * (nl + facing));
  float dull = 0.8 * f * 0.22 * 0.22 / (hidden * hidden);
  float wet = f * 0.06 * 0.06 / (shining * shining);
  shade += kKeyColour * lit * (soft_peak(dull) + 0.55 * soft_peak(wet));
  float film = min(fresnel(0.026, facing), 0.16);
  shade += mirror(reflect(-v, n), 0.22) * film * 1.25 * sky_at_rest * mix(0.45, 1.0, lit);
  pixel = vec4(annotated(finish(shade), light), 1.0);
}
#endif
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

  float shown = key_visible(normalize(n_W));
  float sky = sky_visible();
  float nv = max(dot(n, v), 0.0);
  vec3 f = metal + (1.0 - metal) * pow(1.0 - nv, 5.0);
  vec3 shade = mirror(reflect(-v, n), roughness) * f * sky * mix(0.75, 1.0, shown);
  shade += kKeyColour * 0.55 * shown * highlight(n, v, key, roughness) * f;
  shade += kRimColour * 0.5 * highlight(n, v, rim, roughness) * f * sky;
  shade += kFillColour * 0.5 * highlight(n, v, fill, 0.45) * f * sky;
  shade += metal * 0.10 * (irradiance(n) * sky + kKeyColour * 0.5 * shown * max(dot(n, key), 0.0));
  pixel = vec4(finish(shade * 0.92), 1.0);
}
)";

// Lit from above by lamps of an operating theatre, which cast no hard shadow. It fades into the wall. Folds
// are computed at the vertices: per pixel they would take a third of a picture's time.
const char* const kDrapeVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 2) in float reached;  // share of the light from above that reaches it
uniform mat4 projection;
uniform vec3 middle;
uniform float radius;  // m, where it has faded
out float light;
out float shown;
void main() {
  vec2 from_middle = (position - middle).xy / radius;
  float far = length(from_middle);
  // Long folds, and the shallow unevenness between them.
  vec2 slope = 0.40 * noise(vec3(from_middle * mat2(3.2, 1.1, -0.5, 1.4), 7.0)).yz +
               0.16 * noise(vec3(from_middle * 9.0, 3.0)).yz;
  light = 0.40 + 0.70 * dot(normalize(vec3(-slope, 1.0)), normalize(vec3(-0.5, 0.35, 1.0)));
  light *= mix(0.10, 1.0, reached) * mix(1.0, 0.55, smoothstep(0.15, 0.8, far));
  shown = 1.0 - smoothstep(0.25, 1.0, far);
  gl_Position = projection * vec4(position, 1.0);
  gl_Position.z = 0.0;  // drawn without depths: the far plane must not cut it
}
)";

const char* const kDrape = R"(
in float light;
in float shown;
out vec4 pixel;
uniform vec2 pixel_size;
void main() {
  vec3 cloth = light * vec3(0.092, 0.142, 0.160);
  pixel = vec4(finish(mix(wall(gl_FragCoord.xy * pixel_size), cloth, shown)), 1.0);
}
)";

std::string level(Quality quality) {
  switch (quality) {
    case Quality::kFull:
      return "#define FULL\n";
    case Quality::kFast:
      return "#define FAST\n";
    default:
      return "";
  }
}

}  // namespace

std::string tissue_fragment(Quality quality, Annotated annotated) {
  return kVersion + level(quality) + (annotated == Annotated::kYes ? "#define ANNOTATED\n" : "") + kFinish +
         kNoise + kNoiseValue + kLamps + kMapped + kStudio + kTissue;
}

std::string steel_fragment(Quality quality) {
  return kVersion + level(quality) + "#define STEEL\n" + kFinish + kNoise + kLamps + kStudio + kSteel;
}

std::string drape_vertex() { return std::string(kVersion) + kNoise + kDrapeVertex; }

std::string drape_fragment() { return std::string(kVersion) + kFinish + kWall + kDrape; }

}  // namespace palpate::render::shaders
