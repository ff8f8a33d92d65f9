#include "core/contact/normal_clusters.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

constexpr std::size_t kMostInCell = 64;  // triangles of a cell that is not cut any further
constexpr int kLevels = 20;              // of the octree: cells down to a millionth of the box
constexpr float kSlack = 1.00001F;       // for bounds taken with float's rounding

/// Every third bit from the lowest on.
std::uint64_t spread_bits(std::uint64_t x) noexcept {
  std::uint64_t result = 0;
  for (int bit = 0; bit < kLevels; ++bit) result |= ((x >> bit) & 1U) << (3 * bit);
  return result;
}

struct Place {
  std::uint64_t code;  // on Morton's curve: bits of x, y and z in turn
  std::int32_t triangle;
};

/// The triangles in the order of Morton's curve through the middle of each.
std::vector<Place> places_of(const geometry::TriangleMesh& mesh, const geometry::Bounds& box, double edge) {
  std::vector<Place> places(mesh.triangles.size());
  const double scale = edge > 0.0 ? static_cast<double>(1U << kLevels) / edge : 0.0;
  for_ranges(places.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const geometry::Triangle& triangle = mesh.triangles[t];
      const Vec3 middle =
          (mesh.vertices[at(triangle[0])] + mesh.vertices[at(triangle[1])] + mesh.vertices[at(triangle[2])]) /
          3.0;
      std::uint64_t code = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double cell = (middle[axis] - box.low[axis]) * scale;
        const double last = static_cast<double>((1U << kLevels) - 1U);
        const auto bits = static_cast<std::uint64_t>(cell > 0.0 ? std::min(cell, last) : 0.0);
        code |= spread_bits(bits) << axis;
      }
      places[t] = {code, static_cast<std::int32_t>(t)};
    }
  });
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return a.code != b.code ? a.code < b.code : a.triangle < b.triangle;
  });
  return places;
}

/// Cuts a cell of the octree, `level` cuts above the smallest, until it is small and holds few triangles.
void cut(std::span<const Place> places, int level, int largest_level, std::int32_t& cells,
         std::vector<std::int32_t>& cell_of) {
  if (places.empty()) return;
  if (level == 0 || (level <= largest_level && places.size() <= kMostInCell)) {
    for (const Place& place : places) cell_of[at(place.triangle)] = cells;
    ++cells;
    return;
  }
  const int shift = 3 * (level - 1);
  while (!places.empty()) {
    const std::uint64_t child = places.front().code >> shift;
    const auto end = std::find_if(places.begin(), places.end(),
                                  [&](const Place& place) { return place.code >> shift != child; });
    const auto count = static_cast<std::size_t>(end - places.begin());
    cut(places.first(count), level - 1, largest_level, cells, cell_of);
    places = places.subspan(count);
  }
}

std::array<float, 3> rounded(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vec3 widened(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

std::array<Vec3, 3> corners_of(const SurfaceView& surface, std::int32_t triangle) {
  const geometry::Triangle& corners = surface.mesh.triangles[at(triangle)];
  return {surface.mesh.vertices[at(corners[0])], surface.mesh.vertices[at(corners[1])],
          surface.mesh.vertices[at(corners[2])]};
}

Patch patch_of(const SurfaceView& surface, std::span<const std::int32_t> triangles) {
  constexpr double kFar = 1e30;
  Patch patch;
  Vec3 low = Vec3::Constant(kFar);
  Vec3 high = Vec3::Constant(-kFar);
  Vec3 normals = Vec3::Zero();
  for (const std::int32_t triangle : triangles) {
    for (const Vec3& corner : corners_of(surface, triangle)) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    normals += surface.face_normals[at(triangle)];
  }
  patch.centre = rounded(0.5 * (low + high));
  patch.axis = rounded(normals / static_cast<double>(triangles.size()));
  double reach = 0.0;
  double spread = 0.0;
  double longest = 0.0;
  Vec3 sum_A = Vec3::Zero();
  Eigen::Matrix3d sum_Am = Eigen::Matrix3d::Zero();
  Vec3 sum_Aq = Vec3::Zero();
  for (const std::int32_t triangle : triangles) {
    const std::array<Vec3, 3> corner = corners_of(surface, triangle);
    const Vec3 area = geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[at(triangle)]);
    Vec3 middles = Vec3::Zero();
    double squares = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 middle = 0.5 * (corner[e] + corner[(e + 1) % 3]) - widened(patch.centre);
      middles += middle;
      squares += middle.squaredNorm();
      reach = std::max(reach, (corner[e] - widened(patch.centre)).squaredNorm());
      longest = std::max(longest, (corner[(e + 1) % 3] - corner[e]).squaredNorm());
    }
    sum_A += area;
    sum_Am += area * middles.transpose();
    sum_Aq += squares * area;
    if (area.squaredNorm() > 0.0) {
      spread = std::max(spread, (surface.face_normals[at(triangle)] - widened(patch.axis)).squaredNorm());
    }
  }
  patch.reach = static_cast<float>(std::sqrt(reach)) * kSlack;
  patch.spread = static_cast<float>(std::sqrt(spread)) * kSlack;
  patch.longest_edge = static_cast<float>(std::sqrt(longest));
  patch.sum_A = rounded(sum_A);
  patch.sum_Aq = rounded(sum_Aq);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int place = 3 * row + column;
      patch.sum_Am[static_cast<std::size_t>(place)] = static_cast<float>(sum_Am(row, column));
    }
  }
  return patch;
}

Block block_of(const SurfaceView& surface, std::span<const std::int32_t> triangles) {
  Block block;
  block.patch = patch_of(surface, triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<Vec3, 3> corner = corners_of(surface, triangles[i]);
    const Vec3 centre = (corner[0] + corner[1] + corner[2]) / 3.0;
    double size = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      size += (0.5 * (corner[e] + corner[(e + 1) % 3]) - centre).squaredNorm();
    }
    const std::array<float, 3> middle = rounded(centre - widened(block.patch.centre));
    const std::array<float, 3> normal = rounded(surface.face_normals[at(triangles[i])]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.middle[axis][i] = middle[axis];
      block.normal[axis][i] = normal[axis];
    }
    block.size[i] = static_cast<float>(size);
    block.area[i] = static_cast<float>(
        geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[at(triangles[i])]).norm());
  }
  return block;
}

EdgeMiddles edge_middles_of(const SurfaceView& surface, std::span<const std::int32_t> triangles,
                            const Vec3& centre) {
  EdgeMiddles middles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<Vec3, 3> corner = corners_of(surface, triangles[i]);
    for (std::size_t e = 0; e < 3; ++e) {
      const std::array<float, 3> middle = rounded(0.5 * (corner[e] + corner[(e + 1) % 3]) - centre);
      for (std::size_t axis = 0; axis < 3; ++axis) middles.middle[3 * e + axis][i] = middle[axis];
    }
  }
  return middles;
}

}  // namespace

NormalClusters::NormalClusters(const SurfaceView& surface, double largest, double short_edge) {
  const geometry::Bounds box = geometry::bounds(surface.mesh);
  const double edge = box.size().maxCoeff();
  const std::vector<Place> places = places_of(surface.mesh, box, edge);
  int largest_level = kLevels;
  for (double cell = edge; cell > largest && largest_level > 0; cell *= 0.5) --largest_level;
  std::vector<std::int32_t> cell_of(places.size());
  std::int32_t cells = 0;
  cut(places, kLevels, largest_level, cells, cell_of);
  std::vector<std::int32_t> order(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) order[i] = places[i].triangle;
  grow(surface, order, cell_of);
  sum_up(surface, short_edge);
  link(surface);
}

void NormalClusters::grow(const SurfaceView& surface, const std::vector<std::int32_t>& order,
                          const std::vector<std::int32_t>& cell_of) {
  std::vector<std::int32_t> rank(order.size());  // along the curve
  for (std::size_t i = 0; i < order.size(); ++i) rank[at(order[i])] = static_cast<std::int32_t>(i);
  cluster_of_.assign(order.size(), -1);
  triangles_.reserve(order.size());
  std::int32_t blocks = 0;
  for (const std::int32_t seed : order) {
    if (cluster_of_[at(seed)] >= 0) continue;
    const auto index = static_cast<std::int32_t>(clusters_.size());
    const std::size_t first = triangles_.size();
    clusters_.push_back({{}, static_cast<std::int32_t>(first), blocks, 0});
    triangles_.push_back(seed);
    cluster_of_[at(seed)] = index;
    for (std::size_t i = first; i < triangles_.size(); ++i) {
      for (const std::int32_t next : surface.neighbours[at(triangles_[i])]) {
        if (next < 0 || cluster_of_[at(next)] >= 0 || cell_of[at(next)] != cell_of[at(seed)]) continue;
        if (surface.face_normals[at(seed)].dot(surface.face_normals[at(next)]) < 0.0) continue;
        cluster_of_[at(next)] = index;
        triangles_.push_back(next);
      }
    }
    std::sort(triangles_.begin() + static_cast<std::ptrdiff_t>(first), triangles_.end(),
              [&](std::int32_t a, std::int32_t b) { return rank[at(a)] < rank[at(b)]; });
    blocks += static_cast<std::int32_t>((triangles_.size() - first + Block::kSize - 1) / Block::kSize);
  }
  clusters_.push_back({{}, static_cast<std::int32_t>(triangles_.size()), blocks, 0});
}

void NormalClusters::sum_up(const SurfaceView& surface, double short_edge) {
  blocks_.resize(at(clusters_.back().first_block));
  const auto triangles_from = [&](std::size_t first, std::size_t last) {
    return std::span<const std::int32_t>(triangles_).subspan(first, last - first);
  };
  for_ranges(size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t last = at(clusters_[i + 1].first_triangle);
      std::size_t first = at(clusters_[i].first_triangle);
      clusters_[i].patch = patch_of(surface, triangles_from(first, last));
      for (std::size_t block = at(clusters_[i].first_block); first < last; first += Block::kSize) {
        blocks_[block++] = block_of(surface, triangles_from(first, std::min(first + Block::kSize, last)));
      }
    }
  });
  for (std::size_t i = 0; i < size(); ++i) {
    std::size_t first = at(clusters_[i].first_triangle);
    const std::size_t last = at(clusters_[i + 1].first_triangle);
    for (std::size_t b = at(clusters_[i].first_block); first < last; first += Block::kSize, ++b) {
      Block& block = blocks_[b];
      if (static_cast<double>(block.patch.longest_edge) <= short_edge) continue;
      block.edges = static_cast<std::int32_t>(edge_middles_.size());
      edge_middles_.push_back(edge_middles_of(
          surface, triangles_from(first, std::min(first + Block::kSize, last)), widened(block.patch.centre)));
    }
  }
}

void NormalClusters::link(const SurfaceView& surface) {
  struct Found {
    std::int32_t cluster;
    Link link;
  };
  std::vector<Found> found;
  for (std::size_t i = 0; i < size(); ++i) {
    found.clear();
    for (std::size_t t = at(clusters_[i].first_triangle); t < at(clusters_[i + 1].first_triangle); ++t) {
      for (const std::int32_t next : surface.neighbours[at(triangles_[t])]) {
        if (next < 0 || cluster_of_[at(next)] == static_cast<std::int32_t>(i)) continue;
        found.push_back({cluster_of_[at(next)], {triangles_[t], next}});
      }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Found& a, const Found& b) { return a.cluster < b.cluster; });
    clusters_[i].first_neighbour = static_cast<std::int32_t>(neighbours_.size());
    for (const Found& one : found) {
      const auto index = static_cast<std::int32_t>(links_.size());
      if (&one == &found.front() || neighbours_.back().cluster != one.cluster) {
        neighbours_.push_back({one.cluster, index, index});
      }
      links_.push_back(one.link);
      neighbours_.back().last_link = index + 1;
    }
  }
  clusters_.back().first_neighbour = static_cast<std::int32_t>(neighbours_.size());
}

}  // namespace palpate::contact
