#include "io/mesh_io/repair/crossings.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>

#include "core/base/infinity.h"
#include "io/mesh_io/repair/repair_surface.h"

namespace palpate::mesh_io {
namespace {

constexpr std::size_t kMaxCrossingSteps = 300'000'000;  // about 3 s; a step is a visit of a node
constexpr std::size_t kTestSteps = 10;                  // of a test of two triangles
constexpr std::size_t kMaxPairs = 1'000'000;
constexpr std::size_t kLeaf = 4;  // triangles
// Smaller volumes, relative to the product of their lengths, are rounding errors.
constexpr double kRounding = 1e-12;
constexpr double kShortest = 1e-9;  // of the triangles' size: a shorter common part is a touch

struct Node {
  Box box;
  std::uint32_t begin = 0;  // of the order
  std::uint32_t end = 0;
  std::uint32_t left = 0;  // index of the left child, 0 for a leaf; the right child follows it
};

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

class Search final {
 public:
  explicit Search(const geometry::TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    boxes_.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles) boxes_.push_back(box_of({t}));
    scale_ = 0.0;
    for (const Vec3& v : mesh.vertices) scale_ = std::max(scale_, v.cwiseAbs().maxCoeff());
  }

  Crossings run() {
    if (order_.size() < 2) return {};
    build();
    walk();
    std::sort(found_.pairs.begin(), found_.pairs.end());
    return std::move(found_);
  }

 private:
  void build() {
    nodes_.reserve(order_.size());
    nodes_.push_back({{}, 0, static_cast<std::uint32_t>(order_.size()), 0});
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      Node node = nodes_[n];
      Box centres;
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        node.box.add(boxes_[order_[i]]);
        centres.add(centre(order_[i]));
      }
      if (node.end - node.begin > kLeaf) {
        int axis = 0;
        (void)(centres.high - centres.low).maxCoeff(&axis);
        const std::uint32_t middle = node.begin + (node.end - node.begin) / 2;
        std::nth_element(order_.begin() + node.begin, order_.begin() + middle, order_.begin() + node.end,
                         [&](std::uint32_t a, std::uint32_t b) {
                           const double ca = centre(a)[axis];
                           const double cb = centre(b)[axis];
                           return ca != cb ? ca < cb : a < b;
                         });
        node.left = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({{}, node.begin, middle, 0});
        nodes_.push_back({{}, middle, node.end, 0});
      } else {
        std::sort(order_.begin() + node.begin, order_.begin() + node.end);
      }
      nodes_[n] = node;
    }
  }

  /// For each triangle, tests those after it in the tree's order whose boxes overlap its own, from the root.
  void walk() {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      open.assign(1, 0);
      while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        if (++steps_ > kMaxCrossingSteps || found_.pairs.size() > kMaxPairs) {
          found_.all = false;
          return;
        }
        if (node.end <= i + 1 || !node.box.meets(boxes_[order_[i]])) continue;
        if (node.left == 0) {
          test(i, node);
        } else {
          open.push_back(node.left);
          open.push_back(node.left + 1);
        }
      }
    }
  }

  void test(std::uint32_t i, const Node& leaf) {
    for (std::uint32_t j = std::max(i + 1, leaf.begin); j < leaf.end; ++j) {
      const auto [s, t] = std::minmax(order_[i], order_[j]);
      if (!boxes_[s].meets(boxes_[t])) continue;
      steps_ += kTestSteps;
      if (cross(mesh_.triangles[s], mesh_.triangles[t])) found_.pairs.push_back({s, t});
    }
  }

  [[nodiscard]] bool cross(const geometry::Triangle& s, const geometry::Triangle& t) const {
    int common = 0;
    for (const std::int32_t v : s) common += std::count(t.begin(), t.end(), v) > 0 ? 1 : 0;
    if (common > 1) return false;
    const Box box = box_of({s, t});
    const double size = (box.high - box.low).maxCoeff() + 1e-3 * scale_;
    const Heights of_s = heights(s, t, size);
    if (!of_s.on_both_sides()) return false;
    const Heights of_t = heights(t, s, size);
    if (!of_t.on_both_sides()) return false;
    const Vec3 line = geometry::area_vector_doubled(mesh_, s).cross(geometry::area_vector_doubled(mesh_, t));
    const Interval in_s = cut(s, of_s, line, point(s[0]));
    const Interval in_t = cut(t, of_t, line, point(s[0]));
    return std::min(in_s.high, in_t.high) - std::max(in_s.low, in_t.low) > kShortest * size * line.norm();
  }

  /// Heights of a triangle's corners above another's plane, times twice that triangle's area; 0 within
  /// rounding.
  struct Heights {
    std::array<double, 3> at{};
    [[nodiscard]] bool on_both_sides() const {
      return *std::min_element(at.begin(), at.end()) < 0.0 && *std::max_element(at.begin(), at.end()) > 0.0;
    }
  };

  [[nodiscard]] Heights heights(const geometry::Triangle& s, const geometry::Triangle& t, double size) const {
    Heights found;
    for (std::size_t k = 0; k < 3; ++k) {
      const double height = volume(point(t[0]), point(t[1]), point(t[2]), point(s[k]));
      found.at[k] = std::abs(height) > kRounding * size * size * size ? height : 0.0;
    }
    return found;
  }

  /// Part of the line in which the planes of two triangles meet, as projections on its direction.
  struct Interval {
    double low = kInfinity;
    double high = -kInfinity;
    void add(double at) {
      low = std::min(low, at);
      high = std::max(high, at);
    }
  };

  /// The part that lies in s.
  [[nodiscard]] Interval cut(const geometry::Triangle& s, const Heights& heights, const Vec3& line,
                             const Vec3& origin) const {
    Interval found;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const double from = heights.at[k];
      const double to = heights.at[next];
      const double at = line.dot(point(s[k]) - origin);
      if (from == 0.0) found.add(at);
      if (from * to < 0.0) found.add(at + from / (from - to) * line.dot(point(s[next]) - point(s[k])));
    }
    return found;
  }

  [[nodiscard]] Box box_of(std::initializer_list<geometry::Triangle> triangles) const {
    Box box;
    for (const geometry::Triangle& triangle : triangles) {
      for (const std::int32_t v : triangle) box.add(point(v));
    }
    return box;
  }
  [[nodiscard]] const Vec3& point(std::int32_t v) const {
    return mesh_.vertices[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] Vec3 centre(std::uint32_t t) const { return boxes_[t].low + boxes_[t].high; }

  const geometry::TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
  std::vector<Node> nodes_;
  double scale_ = 0.0;
  std::size_t steps_ = 0;
  Crossings found_;
};

}  // namespace

Crossings find_crossings(const geometry::TriangleMesh& mesh) { return Search(mesh).run(); }

}  // namespace palpate::mesh_io
