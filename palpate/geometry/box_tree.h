#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "palpate/base/pose.h"

// Bounding-volume tree over boxes, for surface_distance.cc.
namespace palpate::geometry {

inline constexpr int kBoxTreeStack = 64;  // > the deepest possible tree

/// Two boxes a node, so that both children are judged before either is fetched.
struct BoxNode {
  std::array<Vec3, 2> low;
  std::array<Vec3, 2> high;
  std::array<std::int32_t, 2> child;  // >= 0: a node; otherwise a leaf: -1 - (first slot)
  std::array<std::int32_t, 2> count;  // slots of a leaf
};

/// Axis-aligned box; empty (inside out) until something is added.
struct Box {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(kFar);
  Vec3 high = Vec3::Constant(-kFar);
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  [[nodiscard]] double half_area() const {
    const Vec3 size = high - low;
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  }
};

/// Builds the nodes over an order of the triangles that it changes as it goes.
class BoxTreeBuilder final {
 public:
  BoxTreeBuilder(const std::vector<Box>& boxes, double padding, std::vector<BoxNode>& nodes)
      : boxes_(boxes), padding_(padding), nodes_(nodes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  /// [setup] Makes the nodes, the root first. @return which box lies at each slot.
  const std::vector<std::int32_t>& build() {
    nodes_.emplace_back();
    const auto count = static_cast<std::int32_t>(order_.size());
    const std::int32_t middle = count > 1 ? partition(0, count, 0) : count;
    fill(0, 0, 0, middle, 1);
    fill(0, 1, middle, count, 1);
    return order_;
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  static constexpr std::int32_t kLeafSize = 2;
  static constexpr int kBins = 16;
  static constexpr int kSahDepth = 28;  // deeper nodes are halved by count, so depth <= 28 + 31

  void fill(std::size_t node, std::size_t side, std::int32_t begin, std::int32_t end, int depth) {
    Box box;
    for (std::int32_t i = begin; i < end; ++i) box.add(box_at(i));
    nodes_[node].low[side] = box.low.array() - padding_;  // an empty side stays inside out: infinitely far
    nodes_[node].high[side] = box.high.array() + padding_;
    if (end - begin <= kLeafSize) {
      nodes_[node].child[side] = -1 - begin;
      nodes_[node].count[side] = end - begin;
      return;
    }
    const auto child = nodes_.size();
    nodes_.emplace_back();
    nodes_[node].child[side] = static_cast<std::int32_t>(child);
    nodes_[node].count[side] = 0;
    const std::int32_t middle = partition(begin, end, depth);
    fill(child, 0, begin, middle, depth + 1);
    fill(child, 1, middle, end, depth + 1);
  }

  /// Surface-area heuristic over bins of the longest axis of the centres; halves by count where that is no
  /// help or the tree grows too deep.
  std::int32_t partition(std::int32_t begin, std::int32_t end, int depth) {
    Box centres;
    for (std::int32_t i = begin; i < end; ++i) centres.add({centre(order_at(i)), centre(order_at(i))});
    int axis = 0;
    const double extent = (centres.high - centres.low).maxCoeff(&axis);
    const auto first = order_.begin() + begin;
    const auto last = order_.begin() + end;
    if (depth < kSahDepth && extent > 0.0) {
      const double to_bin = kBins / extent;
      const auto bin_of = [&](std::int32_t t) {
        return std::min(kBins - 1, static_cast<int>((centre(t)[axis] - centres.low[axis]) * to_bin));
      };
      const int cut = cheapest_cut(begin, end, bin_of);
      const auto middle = std::stable_partition(first, last, [&](std::int32_t t) { return bin_of(t) < cut; });
      if (middle != first && middle != last) return static_cast<std::int32_t>(middle - order_.begin());
    }
    const std::int32_t middle = begin + (end - begin) / 2;
    std::sort(first, last, [&](std::int32_t a, std::int32_t b) {
      const double ca = centre(a)[axis];
      const double cb = centre(b)[axis];
      return ca != cb ? ca < cb : a < b;
    });
    return middle;
  }

  template <typename BinOf>
  int cheapest_cut(std::int32_t begin, std::int32_t end, const BinOf& bin_of) const {
    std::array<Box, kBins> bins;
    std::array<int, kBins> counts{};
    for (std::int32_t i = begin; i < end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(order_at(i)));
      bins[bin].add(box_at(i));
      ++counts[bin];
    }
    std::array<double, kBins> left_cost{};
    Box left;
    int left_count = 0;
    for (std::size_t cut = 1; cut < kBins; ++cut) {
      left.add(bins[cut - 1]);
      left_count += counts[cut - 1];
      left_cost[cut] = left_count == 0 ? kFar : left.half_area() * left_count;
    }
    Box right;
    int right_count = 0;
    double cheapest = kFar;
    int best = kBins / 2;
    for (std::size_t cut = kBins - 1; cut > 0; --cut) {
      right.add(bins[cut]);
      right_count += counts[cut];
      const double cost = right_count == 0 ? kFar : left_cost[cut] + right.half_area() * right_count;
      if (cost < cheapest) {
        cheapest = cost;
        best = static_cast<int>(cut);
      }
    }
    return best;
  }

  [[nodiscard]] std::int32_t order_at(std::int32_t i) const { return order_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Box& box_at(std::int32_t i) const {
    return boxes_[static_cast<std::size_t>(order_at(i))];
  }
  [[nodiscard]] Vec3 centre(std::int32_t t) const {
    const Box& box = boxes_[static_cast<std::size_t>(t)];
    return 0.5 * (box.low + box.high);
  }

  const std::vector<Box>& boxes_;
  double padding_;
  std::vector<BoxNode>& nodes_;
  std::vector<std::int32_t> order_;
};

}  // namespace palpate::geometry
