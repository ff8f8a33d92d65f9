#include "view/render/tissue_pattern.h"

#include <algorithm>
#include <cmath>

#include "core/deform/surface_parts.h"

namespace palpate::render {
namespace {

using Eigen::Vector3f;

float lattice(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 374761393U + static_cast<std::uint32_t>(y) * 668265263U +
                    static_cast<std::uint32_t>(z) * 2147483647U;
  h = (h ^ (h >> 13U)) * 1274126177U;
  h ^= h >> 16U;
  return static_cast<float>(h & 0xffffffU) / 8388607.5F - 1.0F;
}

float mix(float a, float b, float t) { return a + t * (b - a); }

float smoothstep(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

Vector3f turned(const Vector3f& s) {  // rotation, so that patterns do not align with the mesh's axes
  return {0.36F * s.x() - 0.80F * s.y() + 0.48F * s.z(), 0.48F * s.x() + 0.60F * s.y() + 0.64F * s.z(),
          -0.80F * s.x() + 0.60F * s.z()};
}

std::uint8_t byte_of(float share) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
}

Vector3f shifted(const Vector3f& p, float by) { return p + Vector3f::Constant(by); }

StaticVertex pattern_at(const Vector3f& rest, const TissueAppearance& look, float sky) {
  const Vector3f s = turned(rest);
  const Vector3f bend = 0.55F * smooth_noise(turned(s) * look.vessel_per_m * 1.7F).gradient;
  const float patches = 0.62F * smooth_noise(s * look.mottle_per_m * 0.35F).value +
                        0.38F * smooth_noise(shifted(s * look.mottle_per_m * 1.7F, 9.0F)).value;
  Vector3f colour = look.base + (look.mottle - look.base) * smoothstep(-0.45F, 0.45F, patches);
  const float pads =
      smooth_noise(shifted(s * look.vessel_per_m * 0.9F, 71.0F) + 0.25F * bend).value + 0.35F * patches;
  const float fat = look.fat_share * smoothstep(0.22F, 0.62F, pads);
  colour += (look.fat - colour) * fat;
  // Vessels occur in regions and become thin towards their ends: their width follows a pattern of its own
  // with a longer wavelength.
  const float region = smooth_noise(shifted(s * look.vessel_per_m * 0.45F, 31.0F)).value;
  const float width = smoothstep(-0.35F, 0.65F, region + 0.25F * pads);
  StaticVertex vertex;
  vertex.rest = rest;
  for (Eigen::Index k = 0; k < 3; ++k)
    vertex.colour[static_cast<std::size_t>(k)] = byte_of(std::sqrt(colour[k]));
  vertex.colour[3] = byte_of(fat);
  vertex.vessel = shifted(s * look.vessel_per_m + 0.30F * bend, 5.0F);
  vertex.light = {byte_of(sky), byte_of(width), 0, 0};
  return vertex;
}

constexpr int kSides = 40;       // directions from which the sky is sampled
constexpr int kMapSide = 160;    // depth samples per side
constexpr float kLift = 0.012F;  // of the blocker's size: geometry closer than this does not hide the sky

// The smallest whole number not below a value: std::ceil is a call on processors before SSE 4.1.
int whole_from(float value) {
  const int truncated = static_cast<int>(value);
  return truncated + (static_cast<float>(truncated) < value ? 1 : 0);
}

// Depth map of the blocker along one direction.
class PatternDepth final {
 public:
  PatternDepth(const Vector3f& towards, const Vector3f& middle, float radius)
      : z_(towards),
        x_(towards.unitOrthogonal()),
        y_(towards.cross(x_)),
        middle_(middle),
        scale_(0.5F * static_cast<float>(kMapSide - 2) / radius),
        depth_(static_cast<std::size_t>(kMapSide) * kMapSide, -1e9F) {}

  [[nodiscard]] Vector3f placed(const Vector3f& p) const {
    const Vector3f o = p - middle_;
    return {o.dot(x_) * scale_ + 0.5F * kMapSide, o.dot(y_) * scale_ + 0.5F * kMapSide, o.dot(z_)};
  }

  void draw(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
    if (area <= 0.0F) return;  // faces away from the sky direction
    const int last_x = std::min(kMapSide - 1, static_cast<int>(std::max({a.x(), b.x(), c.x()})));
    const int last_y = std::min(kMapSide - 1, static_cast<int>(std::max({a.y(), b.y(), c.y()})));
    for (int i = std::max(0, whole_from(std::min({a.x(), b.x(), c.x()}))); i <= last_x; ++i) {
      for (int j = std::max(0, whole_from(std::min({a.y(), b.y(), c.y()}))); j <= last_y; ++j) {
        const float px = static_cast<float>(i) - a.x();
        const float py = static_cast<float>(j) - a.y();
        const float v = (px * (c.y() - a.y()) - (c.x() - a.x()) * py) / area;
        const float w = ((b.x() - a.x()) * py - px * (b.y() - a.y())) / area;
        if (v < 0.0F || w < 0.0F || v + w > 1.0F) continue;
        float& depth = depth_[static_cast<std::size_t>(i) * kMapSide + static_cast<std::size_t>(j)];
        depth = std::max(depth, a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z()));
      }
    }
  }

  // Fraction of four samples around a position that are not higher than it by more than `lift`.
  [[nodiscard]] float open_at(const Vector3f& place, float lift) const {
    const int i = std::clamp(static_cast<int>(place.x()), 0, kMapSide - 2);
    const int j = std::clamp(static_cast<int>(place.y()), 0, kMapSide - 2);
    float open = 0.0F;
    for (const int k : {0, 1, kMapSide, kMapSide + 1})
      open += depth_[static_cast<std::size_t>(i) * kMapSide + static_cast<std::size_t>(j) +
                     static_cast<std::size_t>(k)] > place.z() + lift
                  ? 0.0F
                  : 0.25F;
    return open;
  }

 private:
  Vector3f z_, x_, y_, middle_;
  float scale_;
  std::vector<float> depth_;
};

}  // namespace

NoiseValue smooth_noise(const Vector3f& p) {
  const Vector3f cell = p.array().floor();
  const Eigen::Vector3i c = cell.cast<int>();
  const Vector3f f = p - cell;
  const Eigen::Array3f a = f.array();
  const Eigen::Array3f s = a * a * a * (a * (a * 6.0F - 15.0F) + 10.0F);
  const Eigen::Array3f ds = 30.0F * a * a * (a * (a - 2.0F) + 1.0F);
  std::array<std::array<std::array<float, 2>, 2>, 2> v{};  // lattice values, indexed by z, y, x
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x)
        v[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] =
            lattice(c.x() + x, c.y() + y, c.z() + z);
  const auto along_z = [&](std::size_t y, std::size_t x) { return mix(v[0][y][x], v[1][y][x], s.z()); };
  const auto rise_z = [&](std::size_t y, std::size_t x) { return v[1][y][x] - v[0][y][x]; };
  const float low = mix(along_z(0, 0), along_z(0, 1), s.x());
  const float high = mix(along_z(1, 0), along_z(1, 1), s.x());
  NoiseValue noise;
  noise.value = mix(low, high, s.y());
  noise.gradient.x() = mix(along_z(0, 1) - along_z(0, 0), along_z(1, 1) - along_z(1, 0), s.y()) * ds.x();
  noise.gradient.y() = (high - low) * ds.y();
  noise.gradient.z() =
      mix(mix(rise_z(0, 0), rise_z(0, 1), s.x()), mix(rise_z(1, 0), rise_z(1, 1), s.x()), s.y()) * ds.z();
  return noise;
}

std::vector<float> sky_visibility(const geometry::TriangleMesh& mesh, const geometry::TriangleMesh& blocker) {
  const geometry::Bounds box = geometry::bounds(blocker);
  const Vector3f middle = box.middle().cast<float>();
  const float radius = std::max(1e-6F, 0.5F * static_cast<float>(box.size().norm()));
  std::vector<Vector3f> corners;
  for (const Vec3& v : blocker.vertices) corners.emplace_back(v.cast<float>());
  std::vector<Vector3f> normals;
  std::vector<Vector3f> lifted;
  for (const Vec3& normal : deform::vertex_normals(mesh)) {
    normals.emplace_back(normal.cast<float>());
    lifted.emplace_back((mesh.vertices[lifted.size()] + kLift * radius * normal).cast<float>());
  }
  std::vector<float> open(mesh.vertices.size(), 0.0F);
  std::vector<float> all(mesh.vertices.size(), 0.0F);
  std::vector<Vector3f> placed(corners.size());
  for (int side = 0; side < kSides; ++side) {
    // Uniform directions on the sphere (Fibonacci spiral).
    const float z = 1.0F - (2.0F * static_cast<float>(side) + 1.0F) / kSides;
    const float turn = 2.39996323F * static_cast<float>(side);
    const float level = std::sqrt(std::max(0.0F, 1.0F - z * z));
    const Vector3f towards(level * std::cos(turn), level * std::sin(turn), z);
    PatternDepth map(towards, middle, radius);
    for (std::size_t v = 0; v < corners.size(); ++v) placed[v] = map.placed(corners[v]);
    for (const geometry::Triangle& t : blocker.triangles)
      map.draw(placed[static_cast<std::size_t>(t[0])], placed[static_cast<std::size_t>(t[1])],
               placed[static_cast<std::size_t>(t[2])]);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const float weight = normals[v].dot(towards);
      if (weight <= 0.0F) continue;
      all[v] += weight;
      open[v] += weight * map.open_at(map.placed(lifted[v]), kLift * radius);
    }
  }
  for (std::size_t v = 0; v < open.size(); ++v) open[v] = all[v] > 0.0F ? open[v] / all[v] : 1.0F;
  return open;
}

std::vector<StaticVertex> tissue_pattern(const geometry::TriangleMesh& rest, const TissueAppearance& look) {
  const std::vector<float> sky = sky_visibility(rest, rest);
  std::vector<StaticVertex> vertices;
  vertices.reserve(rest.vertices.size());
  for (std::size_t v = 0; v < rest.vertices.size(); ++v)
    vertices.push_back(pattern_at(rest.vertices[v].cast<float>(), look, sky[v]));
  return vertices;
}

TissueAppearance tissue_appearance(const std::string& tissue_name) {
  TissueAppearance look;
  if (tissue_name == "gallbladder") {  // bile looks grey-green through the pale wall
    look.base = {0.320F, 0.350F, 0.200F};
    look.mottle = {0.185F, 0.265F, 0.215F};
    look.vessel = {0.33F, 0.085F, 0.06F};
    look.fat = {0.62F, 0.47F, 0.20F};
    look.vessel_share = 0.50F;
    look.fat_share = 0.12F;
    look.vessel_per_m = 62.0F;
  } else if (tissue_name == "heart") {
    look.base = {0.26F, 0.034F, 0.026F};
    look.mottle = {0.34F, 0.072F, 0.052F};
    look.vessel = {0.11F, 0.010F, 0.014F};
    look.fat = {0.56F, 0.34F, 0.12F};
    look.vessel_share = 0.6F;
    look.fat_share = 0.32F;
    look.mottle_per_m = 110.0F;
    look.vessel_per_m = 42.0F;
  } else if (tissue_name == "liver") {
    look.base = {0.100F, 0.0225F, 0.0138F};
    look.mottle = {0.134F, 0.037F, 0.022F};
    look.vessel = {0.085F, 0.016F, 0.012F};
    look.fat = {0.45F, 0.25F, 0.11F};
    look.vessel_share = 0.12F;
  } else if (tissue_name == "kidney") {
    look.base = {0.140F, 0.027F, 0.019F};
    look.mottle = {0.178F, 0.047F, 0.032F};
    look.vessel = {0.13F, 0.016F, 0.013F};
    look.fat = {0.6F, 0.42F, 0.19F};
    look.vessel_share = 0.2F;
    look.fat_share = 0.08F;
  } else {
    look.base = {0.50F, 0.185F, 0.145F};
    look.mottle = {0.58F, 0.27F, 0.21F};
    look.vessel = {0.32F, 0.05F, 0.045F};
    look.fat = {0.66F, 0.46F, 0.22F};
    look.vessel_share = 0.35F;
  }
  return look;
}

}  // namespace palpate::render
