// list_sharp_edges(): the edges across which normals blend.
#include <algorithm>

#include "core/base/index.h"
#include "core/contact/averaged_normals.h"
#include "core/contact/organ_arrays.h"
#include "core/contact/segment.h"

namespace palpate::contact {
namespace {

/// Whether a triangle is within kBlendWidth of the segment from a to b.
bool is_near(const geometry::TriangleMesh& mesh, std::int32_t triangle, const Vec3& a, const Vec3& b) {
  const geometry::Triangle& corners = mesh.triangles[at(triangle)];
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3& p = mesh.vertices[at(corners[c])];
    const Vec3& q = mesh.vertices[at(corners[(c + 1) % 3])];
    double along = 0.0;
    if (distance_to_segment(p, a, b, along) < kBlendWidth ||
        distance_to_segment(a, p, q, along) < kBlendWidth ||
        distance_to_segment(b, p, q, along) < kBlendWidth)
      return true;
  }
  return false;
}

struct NearEdge {
  std::int32_t triangle;
  std::int32_t sharp;
};

}  // namespace

void list_sharp_edges(const SurfaceView& surface, OrganArrays& arrays) {
  const auto& [mesh, neighbours, face_normals] = surface;
  const std::size_t triangle_count = mesh.triangles.size();
  std::vector<NearEdge> near;
  std::vector<std::int32_t> seen_by(triangle_count, -1);
  std::vector<std::int32_t> queue;
  arrays.sharp_edges.clear();
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const auto triangle = static_cast<std::int32_t>(t);
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t other = neighbours[t][e];
      if (other < triangle) continue;  // boundary, or already listed by the other triangle
      if (face_normals[t].dot(face_normals[at(other)]) >= kSharpCosine) continue;
      const auto& back = neighbours[at(other)];
      const std::int32_t edge_of_other = back[0] == triangle ? 0 : (back[1] == triangle ? 1 : 2);
      const auto index = static_cast<std::int32_t>(arrays.sharp_edges.size());
      arrays.sharp_edges.push_back({{triangle, other}, {static_cast<std::int32_t>(e), edge_of_other}});
      const Vec3& a = mesh.vertices[at(mesh.triangles[t][e])];
      const Vec3& b = mesh.vertices[at(mesh.triangles[t][(e + 1) % 3])];
      queue.assign({triangle, other});
      for (std::size_t i = 0; i < 2; ++i) seen_by[at(queue[i])] = index;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        for (const std::int32_t next : neighbours[at(queue[i])]) {
          if (next < 0 || seen_by[at(next)] == index || !is_near(mesh, next, a, b)) continue;
          seen_by[at(next)] = index;
          queue.push_back(next);
        }
      }
      for (const std::int32_t face : queue) near.push_back({face, index});
    }
  }
  // Sorted by triangle, then in the order in which the edges were found.
  arrays.sharp_start.assign(triangle_count + 1, 0);
  for (const NearEdge& one : near) ++arrays.sharp_start[at(one.triangle) + 1];
  for (std::size_t t = 0; t < triangle_count; ++t) arrays.sharp_start[t + 1] += arrays.sharp_start[t];
  std::vector<std::int32_t> next(arrays.sharp_start.begin(), arrays.sharp_start.end() - 1);
  arrays.sharp_near.resize(near.size());
  for (const NearEdge& one : near) arrays.sharp_near[at(next[at(one.triangle)]++)] = one.sharp;
}

}  // namespace palpate::contact
