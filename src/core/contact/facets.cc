#include "core/contact/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

constexpr double kAlikeCosine = 0.97;  // cos 14 degrees: largest turn of a triangle from its facet's first

std::array<Vec3, 3> corners_of(const geometry::TriangleMesh& mesh, std::int32_t triangle) {
  const geometry::Triangle& corners = mesh.triangles[at(triangle)];
  return {mesh.vertices[at(corners[0])], mesh.vertices[at(corners[1])], mesh.vertices[at(corners[2])]};
}

Vec3 middle_of(const std::array<Vec3, 3>& corners) { return (corners[0] + corners[1] + corners[2]) / 3.0; }

float rounded_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

Facet facet_of_triangle(const geometry::TriangleMesh& mesh, std::int32_t triangle) {
  const std::array<Vec3, 3> corners = corners_of(mesh, triangle);
  Facet facet;
  facet.triangle = triangle;
  facet.centre = middle_of(corners);
  facet.area = geometry::area_vector_doubled(mesh, mesh.triangles[at(triangle)]);
  for (const Vec3& corner : corners) {
    const double squared = (corner - facet.centre).squaredNorm();
    facet.squares += 0.25 * squared;  // the opposite edge's midpoint is half as far
    facet.reach = std::max(facet.reach, rounded_up(std::sqrt(squared)));
  }
  return facet;
}

Facet joined(const geometry::TriangleMesh& mesh, std::span<const std::int32_t> triangles) {
  if (triangles.size() == 1) return facet_of_triangle(mesh, triangles[0]);
  Facet all;
  double size = 0.0;
  for (const std::int32_t triangle : triangles) {
    const Vec3 area = geometry::area_vector_doubled(mesh, mesh.triangles[at(triangle)]);
    all.area += area;
    all.centre += area.norm() * middle_of(corners_of(mesh, triangle));
    size += area.norm();
  }
  if (!(size > 0.0)) return facet_of_triangle(mesh, triangles[0]);
  all.centre /= size;
  for (const std::int32_t triangle : triangles) {
    const Facet one = facet_of_triangle(mesh, triangle);
    const double apart = (one.centre - all.centre).norm();
    all.squares += one.area.norm() / size * (3.0 * apart * apart + one.squares);
    all.reach = std::max(all.reach, rounded_up(apart + one.reach));
  }
  return all;
}

}  // namespace

Facets::Facets(const SurfaceView& surface, double size) : facet_of_(surface.mesh.triangles.size(), -1) {
  grow(surface, size);
  link(surface);
  if (!(size > 0.0)) return;
  facets_.resize(start_.size() - 1);
  for_ranges(facets_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      facets_[i] = joined(surface.mesh, triangles(static_cast<std::int32_t>(i)));
    }
  });
}

void Facets::grow(const SurfaceView& surface, double size) {
  triangles_.reserve(facet_of_.size());
  for (std::size_t seed = 0; seed < facet_of_.size(); ++seed) {
    if (facet_of_[seed] >= 0) continue;
    const auto facet = static_cast<std::int32_t>(start_.size());
    start_.push_back(static_cast<std::int32_t>(triangles_.size()));
    triangles_.push_back(static_cast<std::int32_t>(seed));
    facet_of_[seed] = facet;
    if (!(size > 0.0)) continue;
    const Vec3 middle = middle_of(corners_of(surface.mesh, static_cast<std::int32_t>(seed)));
    const auto fits = [&](std::int32_t triangle) {
      const std::array<Vec3, 3> corners = corners_of(surface.mesh, triangle);
      return surface.face_normals[seed].dot(surface.face_normals[at(triangle)]) > kAlikeCosine &&
             std::all_of(corners.begin(), corners.end(),
                         [&](const Vec3& one) { return (one - middle).squaredNorm() <= size * size; });
    };
    for (std::size_t i = at(start_.back()); i < triangles_.size(); ++i) {
      for (const std::int32_t next : surface.neighbours[at(triangles_[i])]) {
        if (next < 0 || facet_of_[at(next)] >= 0 || !fits(next)) continue;
        facet_of_[at(next)] = facet;
        triangles_.push_back(next);
      }
    }
  }
  start_.push_back(static_cast<std::int32_t>(triangles_.size()));
}

void Facets::link(const SurfaceView& surface) {
  const auto count = static_cast<std::int32_t>(start_.size() - 1);
  std::vector<std::int32_t> linked_to(at(count), -1);  // per facet: the last one that lists it as a neighbour
  for (std::int32_t facet = 0; facet < count; ++facet) {
    first_neighbour_.push_back(static_cast<std::int32_t>(neighbours_.size()));
    linked_to[at(facet)] = facet;
    for (const std::int32_t triangle : triangles(facet)) {
      for (const std::int32_t next : surface.neighbours[at(triangle)]) {
        if (next < 0 || linked_to[at(facet_of(next))] == facet) continue;
        linked_to[at(facet_of(next))] = facet;
        neighbours_.push_back(facet_of(next));
      }
    }
  }
  first_neighbour_.push_back(static_cast<std::int32_t>(neighbours_.size()));
}

}  // namespace palpate::contact
