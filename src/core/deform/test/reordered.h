#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::deform {

/// The surface with its vertices in another order. @param order old index of each new vertex
inline geometry::TriangleMesh reordered(const geometry::TriangleMesh& mesh,
                                        const std::vector<std::size_t>& order) {
  geometry::TriangleMesh ordered = mesh;
  std::vector<std::int32_t> now_at(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    ordered.vertices[i] = mesh.vertices[order[i]];
    now_at[order[i]] = static_cast<std::int32_t>(i);
  }
  for (geometry::Triangle& t : ordered.triangles)
    for (std::int32_t& v : t) v = now_at[static_cast<std::size_t>(v)];
  return ordered;
}

}  // namespace palpate::deform
