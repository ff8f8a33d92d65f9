#include "io/mesh_io/repair/repair_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/base/index.h"
#include "core/geometry/cell.h"

namespace palpate::mesh_io {
namespace {

/// Triangles that are connected by manifold edges.
struct Patch {
  double area = 0.0;
  bool has_boundary = false;
  bool meets_others = false;  // at a non-manifold edge
  bool was_doubled = true;    // true for all its triangles
};

/// One round of drop_patches(). @return the dropped patches
template <typename IsDoomed>
RepairCount drop_patches_once(WorkSurface& surface, const IsDoomed& is_doomed) {
  const std::size_t count = surface.mesh.triangles.size();
  DisjointSets sets(count);
  const std::vector<HalfEdge> half_edges = sorted_half_edges(surface.mesh.triangles);
  for_each_edge(half_edges, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 2) sets.unite(first[0].corner / 3, first[1].corner / 3);
  });
  std::vector<Patch> patches(count);  // at the index of the smallest triangle; others empty
  for (std::uint32_t t = 0; t < count; ++t) {
    Patch& patch = patches[sets.find(t)];
    patch.area += surface.area(t);
    if ((surface.marks[t] & kDuplicated) == 0) patch.was_doubled = false;
  }
  for_each_edge(half_edges, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 2) return;
    for (const HalfEdge* side = first; side != last; ++side) {
      Patch& patch = patches[sets.find(side->corner / 3)];
      (last - first == 1 ? patch.has_boundary : patch.meets_others) = true;
    }
  });
  const auto largest = static_cast<std::uint32_t>(
      std::max_element(patches.begin(), patches.end(),
                       [](const Patch& a, const Patch& b) { return a.area < b.area; }) -
      patches.begin());
  RepairCount done;
  std::vector<std::uint8_t> doomed(count, 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t own = sets.find(t);
    if (own == largest || !patches[own].meets_others || !is_doomed(patches[own])) continue;
    doomed[t] = 1;
    if (own == t) ++done.times;
  }
  done.triangles = surface.drop(doomed);
  return done;
}

/// Drops patches at non-manifold edges until nothing changes.
template <typename IsDoomed>
RepairCount drop_patches(WorkSurface& surface, const IsDoomed& is_doomed) {
  constexpr int kMaxRounds = 8;  // dropping one may make the next droppable
  RepairCount done;
  for (int round = 0; round < kMaxRounds; ++round) {
    const RepairCount once = drop_patches_once(surface, is_doomed);
    if (once.triangles == 0) break;
    done.times += once.times;
    done.triangles += once.triangles;
  }
  return done;
}

/// Grows with the angle from 0 to 4 for a full turn, without a trigonometric function.
double pseudo_angle(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (!(sum > 0.0)) return 0.0;
  if (y >= 0.0) return x >= 0.0 ? y / sum : 1.0 - x / sum;
  return x < 0.0 ? 2.0 - y / sum : 3.0 + x / sum;
}

struct Spoke {
  double turn;  // angle of the triangle around the edge, by pseudo_angle()
  Corner corner;
  bool ascends;  // along the edge, from its smaller to its larger vertex index
};

/// Pairs the half-edges of a non-manifold edge so that each pair encloses solid. Seen along the edge and
/// counter-clockwise, a solid begins at a descending half-edge and ends at an ascending one. Where the
/// orientations contradict that, the narrower wedges count as solid. Half-edges of the same patch are paired
/// first.
void pair_around(const WorkSurface& surface, const HalfEdge* first, const HalfEdge* last,
                 DisjointSets& patches, Opposites& opposite) {
  const auto low = static_cast<std::int32_t>(first->edge >> 32);
  const auto high = static_cast<std::int32_t>(first->edge & 0xffffffffU);
  const Vec3 axis = (surface.point(high) - surface.point(low)).normalized();
  Vec3 u = Vec3::Zero();
  std::vector<Spoke> spokes;
  for (const HalfEdge* side = first; side != last; ++side) {
    const Vec3 out = surface.point_at(previous_corner(side->corner)) - surface.point(low);
    const Vec3 across = out - axis.dot(out) * axis;
    if (u.isZero()) u = across.normalized();
    spokes.push_back({pseudo_angle(across.dot(u), across.dot(axis.cross(u))), side->corner,
                      surface.vertex_at(side->corner) == low});
  }
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    return a.turn != b.turn ? a.turn < b.turn : a.corner < b.corner;
  });
  const std::size_t count = spokes.size();
  std::array<int, 2> of_one_patch{0, 0};
  std::array<int, 2> agreeing{0, 0};
  std::array<double, 2> width{0.0, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const Spoke& begin = spokes[i];
    const Spoke& end = spokes[(i + 1) % count];
    if (patches.find(begin.corner / 3) == patches.find(end.corner / 3)) ++of_one_patch[i % 2];
    if (!begin.ascends && end.ascends) ++agreeing[i % 2];
    width[i % 2] += end.turn - begin.turn + (i + 1 == count ? 4.0 : 0.0);
  }
  std::size_t offset = width[1] < width[0] ? 1 : 0;
  if (agreeing[0] != agreeing[1]) offset = agreeing[1] > agreeing[0] ? 1 : 0;
  if (of_one_patch[0] != of_one_patch[1]) offset = of_one_patch[1] > of_one_patch[0] ? 1 : 0;
  for (std::size_t i = offset; i < count + offset; i += 2) {
    const Corner a = spokes[i % count].corner;
    const Corner b = spokes[(i + 1) % count].corner;
    opposite[a] = b;
    opposite[b] = a;
  }
}

}  // namespace

double WorkSurface::area(std::size_t triangle) const {
  return 0.5 * geometry::area_vector_doubled(mesh, mesh.triangles[triangle]).norm();
}

double WorkSurface::area() const {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += area(t);
  return sum;
}

void WorkSurface::turn(std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
  marks[triangle] ^= kReversed;
}

std::size_t WorkSurface::drop(const std::vector<std::uint8_t>& doomed) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (doomed[t] != 0) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    marks[kept] = marks[t];
    ++kept;
  }
  const std::size_t dropped = mesh.triangles.size() - kept;
  if (dropped == 0) return 0;
  mesh.triangles.resize(kept);
  marks.resize(kept);
  drop_unused_vertices(mesh);
  return dropped;
}

void drop_unused_vertices(geometry::TriangleMesh& mesh) {
  std::vector<std::int32_t> name(mesh.vertices.size(), -1);
  for (const geometry::Triangle& triangle : mesh.triangles) {
    for (const std::int32_t v : triangle) name[at(v)] = 0;
  }
  std::size_t used = 0;
  for (std::size_t v = 0; v < name.size(); ++v) {
    if (name[v] < 0) continue;
    mesh.vertices[used] = mesh.vertices[v];
    name[v] = static_cast<std::int32_t>(used++);
  }
  mesh.vertices.resize(used);
  mesh.vertices.shrink_to_fit();  // a mesh of single triangles had six times as many
  for (geometry::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& v : triangle) v = name[at(v)];
  }
}

double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  // The callers round the result to whole turns, so the last bit does not matter; not used in a tick.
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

void unite_fans(const std::vector<geometry::Triangle>& triangles, Corner a, Corner b, DisjointSets& fans) {
  const bool runs_along = triangles[a / 3][a % 3] == triangles[b / 3][b % 3];
  fans.unite(a, runs_along ? b : next_corner(b));
  fans.unite(next_corner(a), runs_along ? next_corner(b) : b);
}

Opposites pair_half_edges(const WorkSurface& surface) {
  Opposites opposite(surface.corners(), kNoOpposite);
  DisjointSets patches(surface.mesh.triangles.size());
  std::vector<std::array<const HalfEdge*, 2>> non_manifold;
  const std::vector<HalfEdge> sides = sorted_half_edges(surface.mesh.triangles);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 2) {
      opposite[first[0].corner] = first[1].corner;
      opposite[first[1].corner] = first[0].corner;
      patches.unite(first[0].corner / 3, first[1].corner / 3);
    } else if ((last - first) % 2 == 0) {
      non_manifold.push_back({first, last});
    }
  });
  for (const auto& [first, last] : non_manifold) pair_around(surface, first, last, patches, opposite);
  return opposite;
}

std::size_t drop_collapsed(WorkSurface& surface) {
  std::vector<std::uint8_t> doomed(surface.mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < doomed.size(); ++t) {
    const auto& [a, b, c] = surface.mesh.triangles[t];
    doomed[t] = a == b || b == c || c == a ? 1 : 0;
  }
  return surface.drop(doomed);
}

std::size_t drop_duplicates(WorkSurface& surface) {
  struct Face {
    geometry::Triangle sorted;
    std::uint32_t triangle;
    bool is_even;  // sorted by an even number of swaps
  };
  std::vector<Face> faces(surface.mesh.triangles.size());
  for (std::uint32_t t = 0; t < faces.size(); ++t) {
    geometry::Triangle sorted = surface.mesh.triangles[t];
    std::rotate(sorted.begin(), std::min_element(sorted.begin(), sorted.end()), sorted.end());
    const bool is_even = sorted[1] <= sorted[2];
    if (!is_even) std::swap(sorted[1], sorted[2]);
    faces[t] = {sorted, t, is_even};
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.triangle < b.triangle;
  });
  std::vector<std::uint8_t> doomed(faces.size(), 0);
  for (std::size_t first = 0, i = 1; i < faces.size(); ++i) {
    if (faces[i].sorted != faces[first].sorted) {
      first = i;
      continue;
    }
    doomed[faces[i].triangle] = 1;
    if (faces[i].is_even != faces[first].is_even) surface.marks[faces[first].triangle] |= kDuplicated;
  }
  return surface.drop(doomed);
}

std::size_t weld_boundaries(WorkSurface& surface, double tolerance) {
  std::vector<std::uint8_t> at_boundary(surface.mesh.vertices.size(), 0);
  bool is_open = false;
  for_each_edge(sorted_half_edges(surface.mesh.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 1) return;
    at_boundary[first->edge >> 32] = at_boundary[first->edge & 0xffffffffU] = 1;
    is_open = true;
  });
  if (!is_open || !(tolerance > 0.0)) return 0;
  std::unordered_map<geometry::Cell, std::int32_t, geometry::ThreeWordsHash>
      cells;                                           // the first vertex of each cell
  const auto find_or_add = [&](std::int32_t vertex) {  // an earlier vertex within the tolerance, or itself
    const Vec3& p = surface.point(vertex);
    const geometry::Cell home = geometry::cell_at(p, tolerance);
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find({home[0] + n % 3 - 1, home[1] + n / 3 % 3 - 1, home[2] + n / 9 - 1});
      if (found != cells.end() && (surface.point(found->second) - p).norm() <= tolerance)
        return found->second;
    }
    cells.try_emplace(home, vertex);
    return vertex;
  };
  std::vector<std::int32_t> name(surface.mesh.vertices.size());
  std::size_t joined = 0;
  for (std::size_t v = 0; v < name.size(); ++v) {
    name[v] = static_cast<std::int32_t>(v);
    if (at_boundary[v] != 0) name[v] = find_or_add(name[v]);
    joined += name[v] == static_cast<std::int32_t>(v) ? 0 : 1;
  }
  if (joined == 0) return 0;
  for (geometry::Triangle& triangle : surface.mesh.triangles) {
    for (std::int32_t& v : triangle) v = name[static_cast<std::size_t>(v)];
  }
  drop_unused_vertices(surface.mesh);
  drop_collapsed(surface);
  return joined;
}

RepairCount drop_dangling_faces(WorkSurface& surface) {
  constexpr double kMaxAreaShare = 0.05;
  const double most = kMaxAreaShare * surface.area();
  return drop_patches(surface, [&](const Patch& p) { return p.has_boundary && p.area <= most; });
}

RepairCount drop_internal_faces(WorkSurface& surface) {
  const auto was_doubled = [](std::uint8_t mark) { return (mark & kDuplicated) != 0; };
  if (std::none_of(surface.marks.begin(), surface.marks.end(), was_doubled)) return {};
  return drop_patches(surface, [](const Patch& p) { return p.was_doubled; });
}

std::size_t split_bow_tie_vertices(WorkSurface& surface, const Opposites& opposite) {
  DisjointSets fans(surface.corners());
  for (Corner c = 0; c < opposite.size(); ++c) {
    if (opposite[c] == kNoOpposite || opposite[c] < c) continue;
    unite_fans(surface.mesh.triangles, c, opposite[c], fans);
  }
  const std::size_t before = surface.mesh.vertices.size();
  std::vector<std::uint32_t> first_fan(before, kNoOpposite);
  std::unordered_map<std::uint32_t, std::int32_t> vertex_of_fan;
  for (Corner c = 0; c < opposite.size(); ++c) {
    const std::uint32_t fan = fans.find(c);
    std::int32_t& vertex = surface.mesh.triangles[c / 3][c % 3];
    const auto old = static_cast<std::size_t>(vertex);
    if (first_fan[old] == kNoOpposite) first_fan[old] = fan;
    if (first_fan[old] == fan) continue;
    const auto [entry, is_new] =
        vertex_of_fan.try_emplace(fan, static_cast<std::int32_t>(surface.mesh.vertices.size()));
    if (is_new) {
      const Vec3 place = surface.mesh.vertices[old];
      surface.mesh.vertices.push_back(place);
    }
    vertex = entry->second;
  }
  return surface.mesh.vertices.size() - before;
}

std::size_t split_non_manifold_edges(WorkSurface& surface, const Opposites& opposite) {
  std::size_t parted = 0;
  std::vector<std::uint8_t> is_cut(surface.mesh.triangles.size(), 0);
  const auto cut = [&](Corner corner, std::int32_t middle) {
    geometry::Triangle& whole = surface.mesh.triangles[corner / 3];
    geometry::Triangle half = whole;
    whole[(corner % 3 + 1) % 3] = middle;
    half[corner % 3] = middle;
    surface.add(half, surface.marks[corner / 3]);
  };
  const std::vector<HalfEdge> sides = sorted_half_edges(surface.mesh.triangles);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first <= 2) return;
    for (const HalfEdge* side = first; side != last; ++side) {
      const Corner across = opposite[side->corner];
      if (across == kNoOpposite || across < side->corner) continue;
      if (is_cut[side->corner / 3] != 0 || is_cut[across / 3] != 0) continue;
      is_cut[side->corner / 3] = is_cut[across / 3] = 1;
      const auto middle = static_cast<std::int32_t>(surface.mesh.vertices.size());
      const Vec3 point = 0.5 * (surface.point_at(side->corner) + surface.point_at(next_corner(side->corner)));
      surface.mesh.vertices.push_back(point);
      cut(side->corner, middle);
      cut(across, middle);
      ++parted;
    }
  });
  return parted;
}

bool orient_consistently(WorkSurface& surface, const Opposites& opposite) {
  const std::size_t count = surface.mesh.triangles.size();
  std::vector<std::uint8_t> seen(count, 0);
  std::vector<std::uint8_t> turned(count, 0);
  std::vector<std::uint32_t> component;
  for (std::uint32_t start = 0; start < count; ++start) {
    if (seen[start] != 0) continue;
    component.assign(1, start);
    seen[start] = 1;
    std::size_t turned_ones = 0;
    for (std::size_t i = 0; i < component.size(); ++i) {
      for (Corner c = 3 * component[i]; c < 3 * component[i] + 3; ++c) {
        if (opposite[c] == kNoOpposite) continue;
        const std::uint32_t other = opposite[c] / 3;
        const bool runs_along = surface.vertex_at(opposite[c]) == surface.vertex_at(c);
        const auto wanted = static_cast<std::uint8_t>(turned[component[i]] ^ (runs_along ? 1 : 0));
        if (seen[other] != 0) {
          if (turned[other] != wanted) return false;
          continue;
        }
        seen[other] = 1;
        turned[other] = wanted;
        turned_ones += wanted;
        component.push_back(other);
      }
    }
    const std::uint8_t majority = 2 * turned_ones > component.size() ? 1 : 0;
    for (const std::uint32_t t : component) turned[t] ^= majority;
  }
  for (std::size_t t = 0; t < count; ++t) {
    if (turned[t] != 0) surface.turn(t);
  }
  return true;
}

std::vector<std::uint32_t> components_of(const Opposites& opposite) {
  DisjointSets sets(opposite.size() / 3);
  for (Corner c = 0; c < opposite.size(); ++c) {
    if (opposite[c] != kNoOpposite && opposite[c] > c) sets.unite(c / 3, opposite[c] / 3);
  }
  std::vector<std::uint32_t> components(opposite.size() / 3);
  for (std::uint32_t t = 0; t < components.size(); ++t) components[t] = sets.find(t);
  return components;
}

}  // namespace palpate::mesh_io
