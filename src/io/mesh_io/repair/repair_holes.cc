#include "io/mesh_io/repair/repair_holes.h"

#include <algorithm>

#include "core/base/infinity.h"
#include "core/geometry/half_edges.h"

namespace palpate::mesh_io {
namespace {

double area_of(const geometry::TriangleMesh& mesh, const geometry::Triangle& triangle) {
  return 0.5 * geometry::area_vector_doubled(mesh, triangle).norm();
}

}  // namespace

std::vector<Hole> holes_of(const WorkSurface& surface, const Opposites& opposite) {
  // A patch runs opposite to the boundary: from each boundary edge's end to its start.
  std::vector<std::int32_t> next(surface.mesh.vertices.size(), -1);
  for (Corner c = 0; c < opposite.size(); ++c) {
    if (opposite[c] != kNoOpposite) continue;
    next[static_cast<std::size_t>(surface.vertex_at(next_corner(c)))] = surface.vertex_at(c);
  }
  std::vector<Hole> holes;
  for (std::size_t start = 0; start < next.size(); ++start) {
    if (next[start] < 0) continue;
    Hole hole;
    Box box;
    for (auto v = static_cast<std::int32_t>(start); v >= 0;) {
      hole.loop.push_back(v);
      box.add(surface.point(v));
      std::int32_t& after = next[static_cast<std::size_t>(v)];
      v = after;
      after = -1;
      if (v == static_cast<std::int32_t>(start)) break;
    }
    hole.width = (box.high - box.low).norm();
    hole.middle = 0.5 * (box.low + box.high);
    holes.push_back(std::move(hole));
  }
  return holes;
}

std::vector<geometry::Triangle> least_area_patch(
    const geometry::TriangleMesh& mesh, const std::vector<std::int32_t>& loop,
    const std::function<bool(std::int32_t, std::int32_t)>& may_join) {
  const std::size_t n = loop.size();
  if (n < 3) return {};
  std::vector<double> least(n * n, 0.0);  // [i, j]: smallest area that closes the loop from i to j
  std::vector<std::size_t> split(n * n, 0);
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double best = kInfinity;
      const bool is_own = i == 0 && j + 1 == n;  // the edge from the last to the first vertex
      if (is_own || may_join(loop[i], loop[j])) {
        for (std::size_t m = i + 1; m < j; ++m) {
          const double rest = least[i * n + m] + least[m * n + j];
          if (!(rest < best)) continue;
          const double area = rest + area_of(mesh, geometry::Triangle{loop[i], loop[m], loop[j]});
          if (area < best) {
            best = area;
            split[i * n + j] = m;
          }
        }
      }
      least[i * n + j] = best;
    }
  }
  if (!(least[n - 1] < kInfinity)) return {};
  std::vector<geometry::Triangle> patch;
  std::vector<std::array<std::size_t, 2>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    if (to < from + 2) continue;
    const std::size_t middle = split[from * n + to];
    patch.push_back({loop[from], loop[middle], loop[to]});
    open.push_back({from, middle});
    open.push_back({middle, to});
  }
  return patch;
}

std::vector<std::uint64_t> edges_of(const WorkSurface& surface) {
  std::vector<std::uint64_t> edges;
  for (const HalfEdge& side : sorted_half_edges(surface.mesh.triangles)) edges.push_back(side.edge);
  return edges;
}

HolePatch patch_of(const WorkSurface& surface, const std::vector<std::uint64_t>& edges, const Hole& hole) {
  HolePatch patch;
  patch.triangles = least_area_patch(surface.mesh, hole.loop, [&](std::int32_t a, std::int32_t b) {
    return !std::binary_search(edges.begin(), edges.end(), geometry::edge_key(a, b));
  });
  for (const geometry::Triangle& triangle : patch.triangles) patch.area += area_of(surface.mesh, triangle);
  if (!patch.triangles.empty()) return patch;
  const std::size_t n = hole.loop.size();
  Vec3 middle = Vec3::Zero();
  for (const std::int32_t v : hole.loop) middle += surface.point(v) / static_cast<double>(n);
  const auto added = static_cast<std::int32_t>(surface.mesh.vertices.size());
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t a = hole.loop[i];
    const std::int32_t b = hole.loop[(i + 1) % n];
    patch.area += 0.5 * (surface.point(a) - middle).cross(surface.point(b) - middle).norm();
    patch.triangles.push_back({a, b, added});
  }
  patch.middle = middle;
  return patch;
}

}  // namespace palpate::mesh_io
