#include "core/geometry/disc_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::geometry {
namespace {

constexpr std::int32_t kChildren = 4;
constexpr float kEmptyLane = -1e30F;  // radius of an empty lane: its squared distance is infinite
constexpr double kNowhere = 1e30;     // m; coordinate of an empty lane's triangle, with the same effect

/// A float that is not smaller, with a margin.
float rounded_up(double value) noexcept {
  constexpr double kMore = 1.0 + 4.0 * std::numeric_limits<float>::epsilon();
  return std::nextafter(static_cast<float>(value * kMore), std::numeric_limits<float>::infinity());
}

/// One disc of a node.
struct Disc {
  std::array<float, 3> centre{};
  std::array<float, 3> axis{0.0F, 0.0F, 1.0F};
  float radius = kEmptyLane;
  float height = 0.0F;
};

/// The disc around a run of triangles; its axis is along the sum of their normals.
Disc disc_around(const TriangleMesh& mesh, std::span<const std::int32_t> run, const Vec3& origin) {
  Vec3 axis = Vec3::Zero();
  for (const std::int32_t t : run) axis += area_vector_doubled(mesh, mesh.triangles[at(t)]);
  const double length = axis.norm();
  axis = length > 0.0 ? Vec3(axis / length) : Vec3(Vec3::UnitZ());
  Disc disc;
  disc.axis = {static_cast<float>(axis.x()), static_cast<float>(axis.y()), static_cast<float>(axis.z())};
  axis = Vec3(disc.axis[0], disc.axis[1], disc.axis[2]).normalized();  // as rounded in the node
  const Vec3 u = axis.unitOrthogonal();
  const Vec3 v = axis.cross(u);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  for (const std::int32_t t : run) {
    for (const std::int32_t corner : mesh.triangles[at(t)]) {
      const Vec3 p = mesh.vertices[at(corner)] - origin;
      const Vec3 turned(p.dot(u), p.dot(v), p.dot(axis));
      low = low.cwiseMin(turned);
      high = high.cwiseMax(turned);
    }
  }
  const Vec3 middle = 0.5 * (low + high);
  const Vec3 centre = middle.x() * u + middle.y() * v + middle.z() * axis;
  disc.centre = {static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                 static_cast<float>(centre.z())};
  const Vec3 kept(disc.centre[0], disc.centre[1], disc.centre[2]);
  double radius_squared = 0.0;
  double height = 0.0;
  for (const std::int32_t t : run) {
    for (const std::int32_t corner : mesh.triangles[at(t)]) {
      const Vec3 p = mesh.vertices[at(corner)] - origin - kept;
      const double along = p.dot(axis);
      height = std::max(height, std::abs(along));
      radius_squared = std::max(radius_squared, (p - along * axis).squaredNorm());
    }
  }
  disc.radius = rounded_up(std::sqrt(radius_squared));
  disc.height = rounded_up(height);
  return disc;
}

}  // namespace

DiscBvh::DiscBvh(const TriangleMesh& mesh) {
  const auto count = static_cast<std::int32_t>(mesh.triangles.size());
  const Bounds box = bounds(mesh);
  origin_ = box.middle();
  extent_ = 0.5 * box.size().maxCoeff();
  std::vector<Vec3> centres(at(count));
  for (std::int32_t t = 0; t < count; ++t) {
    const Triangle& corners = mesh.triangles[at(t)];
    centres[at(t)] =
        mesh.vertices[at(corners[0])] + mesh.vertices[at(corners[1])] + mesh.vertices[at(corners[2])];
  }
  triangle_of_.resize(at(count));
  std::iota(triangle_of_.begin(), triangle_of_.end(), 0);
  order(centres, 0, count);

  fill_leaves(mesh);
  std::size_t nodes = 0;
  std::size_t below = leaves_.size();
  do {
    start_[at(levels_++)] = static_cast<std::uint32_t>(nodes);
    below = (below + kChildren - 1) / kChildren;
    nodes += below;
  } while (below > 1);
  start_[at(levels_)] = static_cast<std::uint32_t>(nodes);
  nodes_.resize(nodes);
  for (int level = 1; level <= levels_; ++level) bound_level(mesh, level);
}

void DiscBvh::fill_leaves(const TriangleMesh& mesh) {
  leaves_.resize((triangle_of_.size() + kChildren - 1) / kChildren);
  constexpr std::size_t kAtOnce = 8192;
  for_ranges(leaves_.size() * kChildren, kAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) fill_lane(mesh, slot);
  });
}

void DiscBvh::fill_lane(const TriangleMesh& mesh, std::size_t slot) {
  TriangleNode& leaf = leaves_[slot / kChildren];
  const std::size_t lane = slot % kChildren;
  Vec3 a = Vec3::Constant(kNowhere);
  Vec3 ab = Vec3::Zero();
  Vec3 ac = Vec3::Zero();
  if (slot < triangle_of_.size()) {
    const Triangle& corners = mesh.triangles[at(triangle_of_[slot])];
    a = mesh.vertices[at(corners[0])] - origin_;
    ab = mesh.vertices[at(corners[1])] - mesh.vertices[at(corners[0])];
    ac = mesh.vertices[at(corners[2])] - mesh.vertices[at(corners[0])];
  }
  leaf.corner_x[lane] = static_cast<float>(a.x());
  leaf.corner_y[lane] = static_cast<float>(a.y());
  leaf.corner_z[lane] = static_cast<float>(a.z());
  leaf.ab_x[lane] = static_cast<float>(ab.x());
  leaf.ab_y[lane] = static_cast<float>(ab.y());
  leaf.ab_z[lane] = static_cast<float>(ab.z());
  leaf.ac_x[lane] = static_cast<float>(ac.x());
  leaf.ac_y[lane] = static_cast<float>(ac.y());
  leaf.ac_z[lane] = static_cast<float>(ac.z());
}

/// Splits at the median of the longest side, at a multiple of the largest power of 4 below the count, so that
/// the tree's runs are halves of halves. The last runs are in order of the triangles' numbers
/// (docs/decisions/0026-one-order-everywhere.md).
void DiscBvh::order(const std::vector<Vec3>& centres, std::int32_t begin, std::int32_t end) {
  struct Range {
    std::int32_t begin;
    std::int32_t end;
  };
  const auto halve = [&](Range range) -> std::int32_t {
    std::int32_t run = 1;
    while (run * kChildren < range.end - range.begin) run *= kChildren;
    if (range.end - range.begin <= 1) return range.end;
    const std::int32_t runs = (range.end - range.begin + run - 1) / run;
    const std::int32_t middle = range.begin + (runs / 2) * run;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (std::int32_t i = range.begin; i < range.end; ++i) {
      const Vec3& centre = centres[at(triangle_of_[at(i)])];
      low = low.cwiseMin(centre);
      high = high.cwiseMax(centre);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto first = triangle_of_.begin();
    std::nth_element(first + range.begin, first + middle, first + range.end,
                     [&](std::int32_t a, std::int32_t b) {
                       const double ca = centres[at(a)][axis];
                       const double cb = centres[at(b)][axis];
                       return ca < cb || (ca == cb && a < b);
                     });
    return middle;
  };
  const auto finish = [&](Range whole) {
    std::vector<Range> open{whole};
    while (!open.empty()) {
      const Range range = open.back();
      open.pop_back();
      if (range.end - range.begin <= kChildren) {
        std::sort(triangle_of_.begin() + range.begin, triangle_of_.begin() + range.end);
        continue;
      }
      const std::int32_t middle = halve(range);
      open.push_back({range.begin, middle});
      open.push_back({middle, range.end});
    }
  };
  // The first levels are split one after another, with all parts of a level in parallel.
  constexpr int kParallelLevels = 4;
  std::vector<Range> ranges{{begin, end}};
  for (int level = 0; level < kParallelLevels; ++level) {
    std::vector<std::int32_t> middles(ranges.size());
    for_ranges(ranges.size(), 1, [&](std::size_t i, std::size_t) {
      const bool small = ranges[i].end - ranges[i].begin <= kChildren;
      middles[i] = small ? ranges[i].end : halve(ranges[i]);
    });
    std::vector<Range> halves;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      halves.push_back({ranges[i].begin, middles[i]});
      if (middles[i] < ranges[i].end) halves.push_back({middles[i], ranges[i].end});
    }
    ranges = std::move(halves);
  }
  for_ranges(ranges.size(), 1, [&](std::size_t i, std::size_t) { finish(ranges[i]); });
}

/// Fills a level: each lane bounds a run of 4^level triangles.
void DiscBvh::bound_level(const TriangleMesh& mesh, int level) {
  std::size_t run = 1;
  for (int i = 0; i < level; ++i) run *= kChildren;
  const std::size_t first = start_[at(level - 1)];
  const std::size_t count = start_[at(level)] - first;
  constexpr std::size_t kTrianglesAtOnce = 4096;
  for_ranges(
      count, std::max<std::size_t>(1, kTrianglesAtOnce / run), [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
          DiscNode& kept = nodes_[first + node];
          for (std::size_t lane = 0; lane < kChildren; ++lane) {
            const std::size_t from = std::min(triangle_of_.size(), (node * kChildren + lane) * run);
            const std::size_t to = std::min(triangle_of_.size(), from + run);
            const Disc disc =
                from < to ? disc_around(mesh, std::span(triangle_of_).subspan(from, to - from), origin_)
                          : Disc{};
            kept.centre_x[lane] = disc.centre[0];
            kept.centre_y[lane] = disc.centre[1];
            kept.centre_z[lane] = disc.centre[2];
            kept.axis_x[lane] = disc.axis[0];
            kept.axis_y[lane] = disc.axis[1];
            kept.axis_z[lane] = disc.axis[2];
            kept.radius[lane] = disc.radius;
            kept.height[lane] = disc.height;
          }
        }
      });
}

}  // namespace palpate::geometry
