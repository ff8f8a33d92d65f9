#include "view/render/drape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "core/base/index.h"

namespace palpate::render {
namespace {

constexpr std::size_t kNodes = 72;     // of the drape on each side
constexpr std::size_t kPatches = 40;   // of the underside on each side
constexpr double kRadius = 2.6;        // of the drape, in radii of the organ
constexpr double kNearestPatch = 0.8;  // of a patch's side: lower ones are summed as if they were so high

struct Patch {
  double x, y, height;  // m
};

/// The organ's underside in squares. Empty squares are infinitely high.
std::vector<Patch> underside(const geometry::TriangleMesh& organ_W, const geometry::Bounds& box,
                             double side) {
  std::vector<Patch> patches;
  for (std::size_t row = 0; row < kPatches; ++row) {
    for (std::size_t column = 0; column < kPatches; ++column) {
      patches.push_back({box.middle().x() + side * (static_cast<double>(column) + 0.5 - 0.5 * kPatches),
                         box.middle().y() + side * (static_cast<double>(row) + 0.5 - 0.5 * kPatches),
                         std::numeric_limits<double>::infinity()});
    }
  }
  const auto index = [&](double length) {
    const double place = std::floor(length / side + 0.5 * kPatches);
    return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kPatches - 1)));
  };
  const auto lower = [&](const Vec3& p) {
    const Vec3 from_middle = p - box.middle();
    Patch& patch = patches[index(from_middle.y()) * kPatches + index(from_middle.x())];
    patch.height = std::min(patch.height, p.z() - box.low.z());
  };
  for (const geometry::Triangle& t : organ_W.triangles) {
    const Vec3& a = organ_W.vertices[at(t[0])];
    const Vec3 ab = organ_W.vertices[at(t[1])] - a;
    const Vec3 ac = organ_W.vertices[at(t[2])] - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const int pieces = 1 + static_cast<int>(2.0 * longest / side);
    for (int i = 0; i <= pieces; ++i)
      for (int j = 0; i + j <= pieces; ++j) lower(a + (i * ab + j * ac) / pieces);
  }
  std::erase_if(patches, [](const Patch& patch) { return !std::isfinite(patch.height); });
  return patches;
}

double light_at(const Vec3& point, std::span<const Patch> patches, double side) {
  double covered = 0.0;
  for (const Patch& patch : patches) {
    const double height = std::max(patch.height, kNearestPatch * side);
    const double far = std::hypot(patch.x - point.x(), patch.y - point.y());
    const double square = height * height + far * far;
    covered += height * height * side * side / (std::numbers::pi * square * square);
  }
  return std::max(0.0, 1.0 - covered);
}

}  // namespace

Drape drape_below(const geometry::TriangleMesh& organ, const Pose& organ_W) {
  geometry::TriangleMesh placed = organ;
  for (Vec3& vertex : placed.vertices) vertex = organ_W * vertex;
  const geometry::Bounds box = geometry::bounds(placed);
  const double side = std::max(box.size().x(), box.size().y()) / static_cast<double>(kPatches);
  const std::vector<Patch> patches = underside(placed, box, side);

  Drape drape;
  drape.middle = {box.middle().x(), box.middle().y(), box.low.z()};
  drape.radius = kRadius * 0.5 * box.size().head<2>().norm();
  const auto from_middle = [&](std::size_t node) {  // closer to each other near the middle
    const double t = 2.0 * static_cast<double>(node) / static_cast<double>(kNodes - 1) - 1.0;
    return drape.radius * (0.4 * t + 0.6 * t * t * t);
  };
  for (std::size_t row = 0; row < kNodes; ++row) {
    for (std::size_t column = 0; column < kNodes; ++column) {
      const Vec3 point = drape.middle + Vec3(from_middle(column), from_middle(row), 0.0);
      drape.vertices.push_back({point.cast<float>(), Eigen::Vector3f::UnitZ(),
                                static_cast<float>(light_at(point, patches, side))});
      if (row + 1 == kNodes || column + 1 == kNodes) continue;
      const auto corner = static_cast<std::uint32_t>(row * kNodes + column);
      constexpr auto kNext = static_cast<std::uint32_t>(kNodes);
      drape.corners.insert(drape.corners.end(), {corner, corner + 1, corner + kNext + 1, corner,
                                                 corner + kNext + 1, corner + kNext});
    }
  }
  return drape;
}

}  // namespace palpate::render
