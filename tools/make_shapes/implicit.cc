#include "tools/make_shapes/implicit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>

namespace palpate::geometry {

FieldValue unite(const FieldValue& a, const FieldValue& b, double blend) noexcept {
  const FieldValue& low = a.value <= b.value ? a : b;
  const FieldValue& high = a.value <= b.value ? b : a;
  const double gap = high.value - low.value;
  if (gap >= blend) return low;
  const double h = (blend - gap) / blend;
  const double share = 0.5 * h * h;  // weight of the larger value
  return {low.value - blend * h * h * h / 6.0, (1.0 - share) * low.gradient + share * high.gradient};
}

FieldValue unite_with_furrow(const FieldValue& a, const FieldValue& b, double width, double depth) noexcept {
  FieldValue sum = unite(a, b, 0.5 * width);
  const double gap = (a.value - b.value) / width;
  if (gap * gap >= 1.0) return sum;
  const double h = 1.0 - gap * gap;
  sum.value += depth * h * h;
  sum.gradient -= 4.0 * depth * h * gap / width * (a.gradient - b.gradient);
  return sum;
}

FieldValue intersect(const FieldValue& a, const FieldValue& b, double blend) noexcept {
  const FieldValue sum = unite({-a.value, -a.gradient}, {-b.value, -b.gradient}, blend);
  return {-sum.value, -sum.gradient};
}

FieldValue subtract(const FieldValue& a, const FieldValue& b, double blend) noexcept {
  return intersect(a, {-b.value, -b.gradient}, blend);
}

FieldValue Ellipsoid::at(const Vec3& p) const noexcept {
  const double x = p.x() - middle.x();
  const double y = p.y() - middle.y();
  const double z = p.z() - middle.z();
  double once2 = 0.0;
  double twice2 = 0.0;
  double gradient[3] = {0.0, 0.0, 0.0};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double half = half_axes[k];
    const double once = (x * axes(0, k) + y * axes(1, k) + z * axes(2, k)) / half;
    const double twice = once / half;
    once2 += once * once;
    twice2 += twice * twice;
    for (Eigen::Index i = 0; i < 3; ++i) gradient[i] += twice * axes(i, k);
  }
  if (twice2 <= 0.0) return {-half_axes.minCoeff(), Vec3::UnitX()};
  const double k = std::sqrt(once2);
  const double g = std::sqrt(twice2);
  return {k * (k - 1.0) / g, Vec3(gradient[0] / g, gradient[1] / g, gradient[2] / g)};
}

Ellipsoid ellipsoid(const Vec3& middle, const Vec3& half_axes, const Vec3& first,
                    const Vec3& second) noexcept {
  Mat3 axes;
  axes.col(0) = first.normalized();
  axes.col(2) = first.cross(second).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {middle, half_axes, axes};
}

namespace {

/// The grid of marching tetrahedra: samples, and the surface vertex of each crossed grid edge.
class Grid final {
 public:
  Grid(const ImplicitSolid& solid, const Bounds& box, double spacing) : low_(box.low), spacing_(spacing) {
    const Vec3 size = box.size();
    for (std::size_t k = 0; k < 3; ++k) {
      count_[k] = static_cast<std::int64_t>(std::ceil(size[static_cast<Eigen::Index>(k)] / spacing)) + 1;
    }
    values_.reserve(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
    for (std::int64_t k = 0; k < count_[2]; ++k) {
      for (std::int64_t j = 0; j < count_[1]; ++j) {
        for (std::int64_t i = 0; i < count_[0]; ++i) values_.push_back(solid.at(place(i, j, k)).value);
      }
    }
  }

  [[nodiscard]] TriangleMesh surface() {
    for (std::int64_t k = 0; k + 1 < count_[2]; ++k) {
      for (std::int64_t j = 0; j + 1 < count_[1]; ++j) {
        for (std::int64_t i = 0; i + 1 < count_[0]; ++i) cube(i, j, k);
      }
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] Vec3 place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return low_ + spacing_ * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  }
  [[nodiscard]] std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (k * count_[1] + j) * count_[0] + i;
  }
  [[nodiscard]] Vec3 place(std::int64_t node) const {
    const std::int64_t row = node / count_[0];
    return place(node % count_[0], row % count_[1], row / count_[1]);
  }
  [[nodiscard]] double value(std::int64_t node) const { return values_[static_cast<std::size_t>(node)]; }

  /// The six tetrahedra around the cube's diagonal (Kuhn), one for each order of the axes, so that
  /// neighbouring cubes divide their common face identically.
  void cube(std::int64_t i, std::int64_t j, std::int64_t k) {
    static constexpr std::array<std::array<int, 3>, 6> kOrders{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (std::size_t n = 0; n < kOrders.size(); ++n) {
      std::array<std::int64_t, 3> at{i, j, k};
      std::array<std::int64_t, 4> nodes{};
      nodes[0] = index(at[0], at[1], at[2]);
      for (std::size_t s = 0; s < 3; ++s) {
        ++at[static_cast<std::size_t>(kOrders[n][s])];
        nodes[s + 1] = index(at[0], at[1], at[2]);
      }
      if (n >= 3) std::swap(nodes[1], nodes[2]);  // odd orders: keeps all tetrahedra right-handed
      tetrahedron(nodes);
    }
  }

  void tetrahedron(const std::array<std::int64_t, 4>& nodes) {
    std::array<std::int64_t, 4> in{};
    std::array<std::int64_t, 4> out{};
    std::size_t ins = 0;
    std::size_t outs = 0;
    std::array<int, 4> order{};
    for (int n = 0; n < 4; ++n) {
      const bool inside = value(nodes[static_cast<std::size_t>(n)]) < 0.0;
      if (inside) {
        order[ins] = n;
        in[ins++] = nodes[static_cast<std::size_t>(n)];
      } else {
        order[3 - outs] = n;
        out[3 - outs] = nodes[static_cast<std::size_t>(n)];
        ++outs;
      }
    }
    if (ins == 0 || outs == 0) return;
    const bool even = is_even(order);
    if (ins == 1) {
      const std::int32_t a =
          cut(in[0], out[1]);  // separate calls: the order of argument evaluation is unspecified
      const std::int32_t b = cut(in[0], out[2]);
      const std::int32_t c = cut(in[0], out[3]);
      emit(a, b, c, even);
    } else if (ins == 3) {
      const std::int32_t a = cut(in[0], out[3]);
      const std::int32_t b = cut(in[1], out[3]);
      const std::int32_t c = cut(in[2], out[3]);
      emit(a, b, c, even);
    } else {
      const std::int32_t a = cut(in[0], out[2]);
      const std::int32_t b = cut(in[0], out[3]);
      const std::int32_t c = cut(in[1], out[3]);
      const std::int32_t d = cut(in[1], out[2]);
      emit(a, b, c, even);
      emit(a, c, d, even);
    }
  }

  [[nodiscard]] static bool is_even(const std::array<int, 4>& order) {
    int swaps = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a + 1; b < 4; ++b) swaps += order[a] > order[b] ? 1 : 0;
    }
    return swaps % 2 == 0;
  }

  void emit(std::int32_t a, std::int32_t b, std::int32_t c, bool forward) {
    if (forward) {
      mesh_.triangles.push_back({a, b, c});
    } else {
      mesh_.triangles.push_back({a, c, b});
    }
  }

  /// The vertex on the grid edge between an inside and an outside node, created once. It stays away from the
  /// nodes, so that no two vertices coincide.
  std::int32_t cut(std::int64_t inside, std::int64_t outside) {
    const std::int64_t total = count_[0] * count_[1] * count_[2];
    const auto [entry, fresh] = made_.try_emplace(inside * total + outside, 0);
    if (fresh) {
      const double t = std::clamp(value(inside) / (value(inside) - value(outside)), 0.05, 0.95);
      const Vec3 a = place(inside);
      entry->second = static_cast<std::int32_t>(mesh_.vertices.size());
      mesh_.vertices.emplace_back(a + t * (place(outside) - a));
    }
    return entry->second;
  }

  Vec3 low_;
  double spacing_;
  std::array<std::int64_t, 3> count_{};
  std::vector<double> values_;
  std::unordered_map<std::int64_t, std::int32_t> made_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh polygonise(const ImplicitSolid& solid, const Bounds& box, double spacing) {
  return Grid(solid, box, spacing).surface();
}

}  // namespace palpate::geometry
