#include "io/mesh_io/repair/crossings.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "core/base/infinity.h"
#include "core/base/simd.h"
#include "io/mesh_io/repair/repair_surface.h"

namespace palpate::mesh_io {
namespace {

constexpr std::size_t kMaxCrossingSteps = 300'000'000;  // about 3 s; a step is a test of two boxes
constexpr std::size_t kTestSteps = 10;                  // of a test of two triangles
constexpr std::size_t kMaxPairs = 1'000'000;
// Smaller volumes, relative to the product of their lengths, are rounding errors.
constexpr double kRounding = 1e-12;
constexpr double kShortest = 1e-9;  // of the triangles' size: a shorter common part is a touch

/// A bounding box in single precision, rounded outwards. The fourth coordinate is 0.
struct FloatBox {
  Float4 low, high;

  explicit FloatBox(const Box& box) {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    std::array<float, 4> lowest{}, highest{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      lowest[k] = std::nextafter(static_cast<float>(box.low[axis]), -kInfinite);
      highest[k] = std::nextafter(static_cast<float>(box.high[axis]), kInfinite);
    }
    low = Float4::load_unaligned(lowest.data());
    high = Float4::load_unaligned(highest.data());
  }
  void add(const FloatBox& other) {
    low = min(low, other.low);
    high = max(high, other.high);
  }
  [[nodiscard]] bool meets(const FloatBox& other) const {
    return none((low > other.high) | (other.low > high));
  }
};

/// The 21 low bits of a number, two zeros after each.
std::uint64_t spread(std::uint64_t n) {
  n = (n | n << 32) & 0x001f00000000ffffU;
  n = (n | n << 16) & 0x001f0000ff0000ffU;
  n = (n | n << 8) & 0x100f00f00f00f00fU;
  n = (n | n << 4) & 0x10c30c30c30c30c3U;
  return (n | n << 2) & 0x1249249249249249U;
}

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

class Search final {
 public:
  explicit Search(const geometry::TriangleMesh& mesh) : mesh_(mesh) {
    for (const Vec3& v : mesh.vertices) scale_ = std::max(scale_, v.cwiseAbs().maxCoeff());
  }

  Crossings run() {
    if (mesh_.triangles.size() < 2) return {};
    sort_along_curve();
    bound();
    walk();
    std::sort(found_.pairs.begin(), found_.pairs.end());
    return std::move(found_);
  }

 private:
  /// Sorts the triangles along a Z-order curve [Morton 1966], on which neighbours are mostly near each other.
  void sort_along_curve() {
    constexpr double kCells = 0x1p21;
    const geometry::Bounds bounds = geometry::bounds(mesh_);
    const double cells_per_length = (1.0 - 1e-9) * kCells / bounds.size().maxCoeff();
    std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
    codes.reserve(mesh_.triangles.size());
    for (const geometry::Triangle& t : mesh_.triangles) {
      const Box box = box_of({t});
      const Vec3 cell = cells_per_length * (0.5 * box.low + 0.5 * box.high - bounds.low);
      std::uint64_t code = 0;
      for (const double along : cell) code = code << 1 | spread(static_cast<std::uint64_t>(along));
      codes.emplace_back(code, static_cast<std::uint32_t>(codes.size()));
    }
    std::sort(codes.begin(), codes.end());
    order_.reserve(codes.size());
    for (const auto& [code, triangle] : codes) order_.push_back(triangle);
  }

  /// Bounds each triangle, then two boxes of a level with one of the next, until there is only one.
  void bound() {
    std::size_t boxes = order_.size();
    for (std::size_t n = boxes; n > 1; boxes += n) n = (n + 1) / 2;
    boxes_.reserve(boxes);
    for (const std::uint32_t t : order_) boxes_.emplace_back(box_of({mesh_.triangles[t]}));
    levels_.push_back({0, order_.size()});
    while (levels_.back().size > 1) {
      const Level below = levels_.back();
      levels_.push_back({boxes_.size(), (below.size + 1) / 2});
      for (std::size_t i = 0; i < below.size; i += 2) {
        boxes_.push_back(boxes_[below.first + i]);
        if (i + 1 < below.size) boxes_.back().add(boxes_[below.first + i + 1]);
      }
    }
  }

  /// Tests all pairs of triangles whose boxes overlap, from the pair of the root with itself.
  void walk() {
    struct Pair {
      std::size_t level, a, b;
    };
    std::vector<Pair> open{{levels_.size() - 1, 0, 0}};
    while (!open.empty()) {
      const Pair pair = open.back();
      open.pop_back();
      const Level& below = levels_[pair.level - 1];
      for (std::size_t a = 2 * pair.a; a < std::min(2 * pair.a + 2, below.size); ++a) {
        for (std::size_t b = std::max(a, 2 * pair.b); b < std::min(2 * pair.b + 2, below.size); ++b) {
          if (++steps_ > kMaxCrossingSteps || found_.pairs.size() > kMaxPairs) {
            found_.all = false;
            return;
          }
          if (!boxes_[below.first + a].meets(boxes_[below.first + b])) continue;
          if (pair.level > 1) {
            open.push_back({pair.level - 1, a, b});
          } else if (a != b) {
            test(order_[a], order_[b]);
          }
        }
      }
    }
  }

  void test(std::uint32_t one, std::uint32_t other) {
    const auto [s, t] = std::minmax(one, other);
    steps_ += kTestSteps;
    if (cross(mesh_.triangles[s], mesh_.triangles[t]) &&
        box_of({mesh_.triangles[s]}).meets(box_of({mesh_.triangles[t]})))
      found_.pairs.push_back({s, t});
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

  struct Level {
    std::size_t first;  // of boxes_
    std::size_t size;
  };

  const geometry::TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<FloatBox> boxes_;  // of the triangles in that order, then of pairs of boxes
  std::vector<Level> levels_;
  double scale_ = 0.0;
  std::size_t steps_ = 0;
  Crossings found_;
};

}  // namespace

Crossings find_crossings(const geometry::TriangleMesh& mesh) { return Search(mesh).run(); }

}  // namespace palpate::mesh_io
