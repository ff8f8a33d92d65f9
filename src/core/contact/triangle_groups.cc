#include "core/contact/triangle_groups.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

constexpr std::size_t kFew = 8;        // a node with no more triangles is a leaf
constexpr double kAlikeCosine = 0.97;  // cos 14 degrees: largest turn of a triangle from its group's first

std::array<Vec3, 3> corners_of(const geometry::TriangleMesh& mesh, std::int32_t triangle) {
  const geometry::Triangle& corners = mesh.triangles[at(triangle)];
  return {mesh.vertices[at(corners[0])], mesh.vertices[at(corners[1])], mesh.vertices[at(corners[2])]};
}

TriangleMoments piece_of(const SurfaceView& surface, std::int32_t triangle) {
  const std::array<Vec3, 3> corner = corners_of(surface.mesh, triangle);
  TriangleMoments piece;
  piece.centre = (corner[0] + corner[1] + corner[2]) / 3.0;
  piece.normal = surface.face_normals[at(triangle)];
  piece.area = geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[at(triangle)]);
  for (std::size_t i = 0; i < 3; ++i) {
    piece.middle[i] = -0.5 * (corner[i] - piece.centre);
    piece.squares += piece.middle[i].squaredNorm();
    piece.middles = std::max(piece.middles, piece.middle[i].norm());
  }
  return piece;
}

GroupMoments moments_of(std::span<const TriangleMoments> all, std::size_t first, std::size_t number) {
  const std::span<const TriangleMoments> pieces = all.subspan(first, number);
  GroupMoments moments;
  moments.first = first;
  moments.count = number;
  const auto count = static_cast<double>(pieces.size());
  for (const TriangleMoments& piece : pieces) {
    moments.centre += piece.centre / count;
    moments.axis += piece.normal / count;
  }
  for (const TriangleMoments& piece : pieces) {
    const Vec3 apart = piece.centre - moments.centre;
    moments.sum_A += piece.area;
    moments.sum_Am += 3.0 * piece.area * apart.transpose();
    moments.sum_Aq += (3.0 * apart.squaredNorm() + piece.squares) * piece.area;
    moments.reach = std::max(moments.reach, apart.norm() + 2.0 * piece.middles);
    if (piece.area.squaredNorm() > 0.0) {
      moments.spread = std::max(moments.spread, (piece.normal - moments.axis).norm());
    }
  }
  return moments;
}

/// Writes the moments of `all`, then those of each half, recursively. Sorts the pieces in that order.
void divide(std::span<TriangleMoments> all, std::size_t first, std::size_t count,
            std::vector<GroupMoments>& nodes) {
  const std::size_t node = nodes.size();
  nodes.push_back(moments_of(all, first, count));
  if (count > kFew) {
    const std::span<TriangleMoments> pieces = all.subspan(first, count);
    Vec3 low = pieces[0].centre;
    Vec3 high = low;
    for (const TriangleMoments& piece : pieces) {
      low = low.cwiseMin(piece.centre);
      high = high.cwiseMax(piece.centre);
    }
    Eigen::Index longest = 0;
    (high - low).maxCoeff(&longest);
    const std::size_t half = count / 2;
    // Stable: the order of the sums must not depend on the C++ library
    // (docs/decisions/0026-one-order-everywhere.md).
    std::stable_sort(pieces.begin(), pieces.end(), [&](const TriangleMoments& a, const TriangleMoments& b) {
      return a.centre[longest] < b.centre[longest];
    });
    divide(all, first, half, nodes);
    divide(all, first + half, count - half, nodes);
  }
  nodes[node].after = nodes.size();
}

}  // namespace

void GroupMoments::add_to(NormalSum& sum, const Vec3& u, double radius) const noexcept {
  const double inverse = 1.0 / (radius * radius);
  sum.sum += (3.0 - 3.0 * inverse * u.squaredNorm()) * sum_A + inverse * (2.0 * (sum_Am * u) - sum_Aq);
  sum.slope += inverse * (2.0 * sum_Am - 6.0 * sum_A * u.transpose());
}

TriangleGroups::TriangleGroups(const SurfaceView& surface, double size)
    : group_of_(surface.mesh.triangles.size(), -1) {
  grow(surface, size);
  link(surface);
  if (!(size > 0.0)) return;
  pieces_.resize(triangles_.size());
  nodes_.resize(this->size());
  for_ranges(nodes_.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = at(start_[i]);
      const std::size_t last = at(start_[i + 1]);
      for (std::size_t k = first; k < last; ++k) pieces_[k] = piece_of(surface, triangles_[k]);
      divide(pieces_, first, last - first, nodes_[i]);
    }
  });
}

void TriangleGroups::grow(const SurfaceView& surface, double size) {
  triangles_.reserve(group_of_.size());
  for (std::size_t seed = 0; seed < group_of_.size(); ++seed) {
    if (group_of_[seed] >= 0) continue;
    const auto group = static_cast<std::int32_t>(start_.size());
    start_.push_back(static_cast<std::int32_t>(triangles_.size()));
    triangles_.push_back(static_cast<std::int32_t>(seed));
    group_of_[seed] = group;
    if (!(size > 0.0)) continue;
    const std::array<Vec3, 3> corner = corners_of(surface.mesh, static_cast<std::int32_t>(seed));
    const Vec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
    const auto belongs = [&](std::int32_t triangle) {
      const std::array<Vec3, 3> corners = corners_of(surface.mesh, triangle);
      return group_of_[at(triangle)] < 0 &&
             surface.face_normals[seed].dot(surface.face_normals[at(triangle)]) > kAlikeCosine &&
             std::all_of(corners.begin(), corners.end(),
                         [&](const Vec3& one) { return (one - middle).squaredNorm() <= size * size; });
    };
    for (std::size_t i = at(start_.back()); i < triangles_.size(); ++i) {
      for (const std::int32_t next : surface.neighbours[at(triangles_[i])]) {
        if (next < 0 || !belongs(next)) continue;
        group_of_[at(next)] = group;
        triangles_.push_back(next);
      }
    }
  }
  start_.push_back(static_cast<std::int32_t>(triangles_.size()));
}

void TriangleGroups::link(const SurfaceView& surface) {
  std::vector<std::int32_t> linked_to(size(), -1);  // per group: the last group that lists it as a neighbour
  for (std::int32_t group = 0; at(group) < size(); ++group) {
    first_neighbour_.push_back(static_cast<std::int32_t>(neighbours_.size()));
    linked_to[at(group)] = group;
    for (const std::int32_t triangle : triangles(group)) {
      for (const std::int32_t next : surface.neighbours[at(triangle)]) {
        if (next < 0 || linked_to[at(group_of(next))] == group) continue;
        linked_to[at(group_of(next))] = group;
        neighbours_.push_back(group_of(next));
      }
    }
  }
  first_neighbour_.push_back(static_cast<std::int32_t>(neighbours_.size()));
}

}  // namespace palpate::contact
