#pragma once
#include <bit>
#include <limits>

#include "core/base/simd.h"
#include "core/geometry/disc_bvh.h"

// Nearest-point and segment traversal of DiscBvh, four discs at a time in single precision. Traversal only
// excludes triangles; the caller computes the rest in double precision, so no result depends on single
// precision.
namespace palpate::geometry {

/// A query point relative to the tree's origin, and the rounding error of single precision.
struct DiscQuery {
  static constexpr float kRounding = 32.0F * std::numeric_limits<float>::epsilon();
  Float4 x, y, z, slack;
  DiscQuery(const Vec3& relative, double extent) noexcept
      : x(static_cast<float>(relative.x())),
        y(static_cast<float>(relative.y())),
        z(static_cast<float>(relative.z())),
        slack(kRounding * static_cast<float>(relative.cwiseAbs().maxCoeff() + extent)) {}

  /// Lower bounds of the squared distances to four discs.
  [[nodiscard]] Float4 squared_distances(const DiscNode& node) const noexcept {
    const Float4 dx = x - Float4::load_aligned(node.centre_x.data());
    const Float4 dy = y - Float4::load_aligned(node.centre_y.data());
    const Float4 dz = z - Float4::load_aligned(node.centre_z.data());
    const Float4 along = dx * Float4::load_aligned(node.axis_x.data()) +
                         dy * Float4::load_aligned(node.axis_y.data()) +
                         dz * Float4::load_aligned(node.axis_z.data());
    const Float4 squared = dx * dx + dy * dy + dz * dz;
    const Float4 zero(0.0F);
    const Float4 across = sqrt(max(zero, squared * Float4(1.0F - kRounding) - along * along));
    const Float4 beside = max(zero, across - Float4::load_aligned(node.radius.data()) - slack);
    const Float4 above = max(zero, abs(along) - Float4::load_aligned(node.height.data()) - slack);
    return beside * beside + above * above;
  }

  /// Lower bounds of the squared distances to four triangles; NaN where rounding leaves them undecided.
  [[nodiscard]] Float4 squared_distances(const TriangleNode& node) const noexcept;
};

/// Four vectors.
struct Float4Vector {
  Float4 x, y, z;
  [[nodiscard]] Float4Vector operator-(const Float4Vector& b) const noexcept {
    return {x - b.x, y - b.y, z - b.z};
  }
  [[nodiscard]] Float4 dot(const Float4Vector& b) const noexcept { return x * b.x + y * b.y + z * b.z; }
  [[nodiscard]] Float4Vector cross(const Float4Vector& b) const noexcept {
    return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
  }
  /// Squared distance of the vector's end from the segment from the origin to `edge`.
  [[nodiscard]] Float4 squared_to_edge(const Float4Vector& edge) const noexcept {
    const Float4 length =
        edge.dot(edge) + Float4(std::numeric_limits<float>::min());  // an edge may be a point
    const Float4 along = min(Float4(1.0F), max(Float4(0.0F), dot(edge) / length));
    const Float4Vector off{x - along * edge.x, y - along * edge.y, z - along * edge.z};
    return off.dot(off);
  }
};

inline Float4 DiscQuery::squared_distances(const TriangleNode& node) const noexcept {
  const auto load = [](const std::array<float, 4>& values) { return Float4::load_aligned(values.data()); };
  const Float4Vector ab{load(node.ab_x), load(node.ab_y), load(node.ab_z)};
  const Float4Vector ac{load(node.ac_x), load(node.ac_y), load(node.ac_z)};
  const Float4Vector bc = ac - ab;
  const Float4Vector ap{x - load(node.corner_x), y - load(node.corner_y), z - load(node.corner_z)};
  const Float4Vector bp = ap - ab;
  const Float4Vector normal = ab.cross(ac);
  const Float4 zero(0.0F);
  const Float4 height = ap.dot(normal);
  // The face counts when the point is inside all three edges. If rounding decides that wrongly, an edge is
  // equally near.
  const auto inside = normal.dot(ab.cross(ap)) >= zero && normal.dot(bc.cross(bp)) >= zero &&
                      normal.dot(ap.cross(ac)) >= zero;
  const Float4 to_plane = height * height / normal.dot(normal);
  const Float4 to_edges = min(min(ap.squared_to_edge(ab), ap.squared_to_edge(ac)), bp.squared_to_edge(bc));
  const Float4 distance = sqrt(select(inside, min(to_plane, to_edges), to_edges));
  const Float4 least = max(zero, distance - slack);
  return least * least;
}

template <typename Visit, typename Reach>
void DiscBvh::each_within(const Vec3& p, Visit visit, Reach reach) const noexcept {
  struct Wait {
    float squared;
    std::uint32_t index;  // of the node in its level
    int level;
  };
  const DiscQuery query(p - origin_, extent_);
  // Rounded up, so that rounding excludes nothing equally near; finite, so that empty lanes stay out of
  // reach.
  constexpr double kMax = 0.25 * std::numeric_limits<float>::max();
  const auto limit = [&reach] {
    const double squared = reach();
    return static_cast<float>(squared < kMax ? squared : kMax) * (1.0F + DiscQuery::kRounding);
  };
  std::array<Wait, kMaxVisits> waiting;
  std::size_t count = 0;
  Wait here{0.0F, 0, levels_};
  float within = limit();
  alignas(16) std::array<float, 4> squared;
  while (true) {
    const bool leaf = here.level == 0;
    const Float4 bounds = leaf ? query.squared_distances(leaves_[here.index])
                               : query.squared_distances(node_at(here.level, here.index));
    bounds.store_unaligned(squared.data());
    // The lanes in reach, the nearest on top.
    const std::size_t below = count;
    for (std::uint32_t lanes = lanes_of(!(bounds > Float4(within))); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      std::size_t at = count++;
      for (; at > below && waiting[at - 1].squared < squared[lane]; --at) waiting[at] = waiting[at - 1];
      waiting[at] = {squared[lane], 4 * here.index + lane, here.level - 1};
    }
    if (leaf) {
      for (; count > below; --count) {
        const std::uint32_t slot = waiting[count - 1].index;
        if (waiting[count - 1].squared > within || slot >= triangle_of_.size()) continue;
        visit(static_cast<std::int32_t>(slot));
        within = limit();
      }
    }
    do {
      if (count == 0) return;
      here = waiting[--count];
    } while (here.squared > within);
  }
}

/// A segment against four discs. A disc is excluded when its bounding sphere is farther away than the slack,
/// or the segment is on one side of its slab.
struct DiscSegment {
  DiscQuery start;
  Float4 x, y, z;  // from start to end
  Float4 inverse_squared_length;
  Float4 slack;

  DiscSegment(const Vec3& a, const Vec3& b, double extent, double given_slack) noexcept
      : start(a, extent + (b - a).norm()),
        x(static_cast<float>((b - a).x())),
        y(static_cast<float>((b - a).y())),
        z(static_cast<float>((b - a).z())),
        inverse_squared_length(static_cast<float>(1.0 / (b - a).squaredNorm())),
        slack(start.slack + Float4(static_cast<float>(2.0 * given_slack))) {}

  /// One bit per lane: may be within the slack.
  [[nodiscard]] std::uint32_t near(const DiscNode& node) const noexcept {
    const Float4 dx = Float4::load_aligned(node.centre_x.data()) - start.x;
    const Float4 dy = Float4::load_aligned(node.centre_y.data()) - start.y;
    const Float4 dz = Float4::load_aligned(node.centre_z.data()) - start.z;
    const Float4 radius = Float4::load_aligned(node.radius.data());
    const Float4 height = Float4::load_aligned(node.height.data());
    const Float4 zero(0.0F);
    const Float4 one(1.0F);
    const Float4 along = min(one, max(zero, (dx * x + dy * y + dz * z) * inverse_squared_length));
    const Float4 rx = dx - along * x;
    const Float4 ry = dy - along * y;
    const Float4 rz = dz - along * z;
    const Float4 reach = sqrt(radius * radius + height * height) + slack;
    const auto in_ball = rx * rx + ry * ry + rz * rz <= reach * reach;
    const Float4 axis_x = Float4::load_aligned(node.axis_x.data());
    const Float4 axis_y = Float4::load_aligned(node.axis_y.data());
    const Float4 axis_z = Float4::load_aligned(node.axis_z.data());
    // the disc's centre relative to the start, along the axis
    const Float4 from = dx * axis_x + dy * axis_y + dz * axis_z;
    const Float4 to = from - (x * axis_x + y * axis_y + z * axis_z);
    const auto in_slab = min(from, to) <= height + slack && max(from, to) >= -(height + slack);
    return lanes_of(in_ball && in_slab && radius >= zero);
  }
};

template <typename Visit>
void DiscBvh::each_along(const Vec3& a, const Vec3& b, double slack, Visit visit) const noexcept {
  struct Wait {
    std::uint32_t index;
    int level;
  };
  const DiscSegment segment(a - origin_, b - origin_, extent_, slack);
  std::array<Wait, kMaxVisits> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, levels_};
  while (count > 0) {
    const Wait here = waiting[--count];
    std::uint32_t lanes = segment.near(node_at(here.level, here.index));
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t child = 4 * here.index + static_cast<std::uint32_t>(std::countr_zero(lanes));
      if (here.level == 1) {
        visit_leaf(child, visit);
      } else {
        waiting[count++] = {child, here.level - 1};
      }
    }
  }
}

}  // namespace palpate::geometry
