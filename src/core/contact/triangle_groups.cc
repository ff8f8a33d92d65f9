#include "core/contact/triangle_groups.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

constexpr double kAlikeCosine = 0.97;  // of 14 degrees: no triangle of a group is turned more from its first

std::array<Vec3, 3> corners_of(const geometry::TriangleMesh& mesh, std::int32_t triangle) {
  const geometry::Triangle& corners = mesh.triangles[at(triangle)];
  return {mesh.vertices[at(corners[0])], mesh.vertices[at(corners[1])], mesh.vertices[at(corners[2])]};
}

GroupMoments moments_of(const SurfaceView& surface, std::span<const std::int32_t> triangles) {
  GroupMoments moments;
  const auto count = static_cast<double>(triangles.size());
  for (const std::int32_t triangle : triangles) {
    for (const Vec3& corner : corners_of(surface.mesh, triangle)) moments.centre += corner / (3.0 * count);
    moments.axis += surface.face_normals[at(triangle)] / count;
  }
  for (const std::int32_t triangle : triangles) {
    const std::array<Vec3, 3> corner = corners_of(surface.mesh, triangle);
    const Vec3 area = geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[at(triangle)]);
    Vec3 middles = Vec3::Zero();
    double squares = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 middle = 0.5 * (corner[e] + corner[(e + 1) % 3]) - moments.centre;
      middles += middle;
      squares += middle.squaredNorm();
      moments.reach = std::max(moments.reach, (corner[e] - moments.centre).norm());
    }
    moments.sum_A += area;
    moments.sum_Am += area * middles.transpose();
    moments.sum_Aq += squares * area;
    if (area.squaredNorm() > 0.0) {
      moments.spread = std::max(moments.spread, (surface.face_normals[at(triangle)] - moments.axis).norm());
    }
  }
  return moments;
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
  moments_.resize(this->size());
  for_ranges(moments_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const std::int32_t> own = triangles(static_cast<std::int32_t>(i));
      if (own.size() > 1) moments_[i] = moments_of(surface, own);
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
  std::vector<std::int32_t> linked_to(size(), -1);  // the last group that each is a neighbour of
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
