#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "palpate/mesh.h"

namespace palpate::deform {

/// Quadratic B-splines on cubic cells over an organ. A displacement field has one vector per node, and at
/// each point the weighted sum of the 27 nodes of its cell. The field and its slope are continuous, so a few
/// hundred nodes describe how an organ bends and bulges.
class CellGrid final {
 public:
  static constexpr std::size_t kNodesOfCell = 27;

  /// A point's cell, and its position in it from 0 to 1; points outside the grid continue the nearest cell.
  struct Place {
    std::array<int, 3> cell{};
    std::array<double, 3> within{};
  };
  /// The values of the three splines of one axis.
  using Splines = std::array<double, 3>;

  /// [setup] @param edge of a cell [m], > 0
  CellGrid(const geometry::Bounds& box, double edge);

  [[nodiscard]] double edge() const noexcept { return edge_; }
  [[nodiscard]] const std::array<int, 3>& cells() const noexcept { return cells_; }
  [[nodiscard]] const Vec3& low() const noexcept { return low_; }
  /// [any] Nodes of the whole grid.
  [[nodiscard]] std::size_t nodes() const noexcept {
    return stride(0) * static_cast<std::size_t>(cells_[0] + 2);
  }
  /// [any] Step of a node's number along an axis.
  [[nodiscard]] std::size_t stride(std::size_t axis) const noexcept { return strides_[axis]; }
  /// [any] The first node of a cell; the others are up to two strides further along each axis.
  [[nodiscard]] std::size_t first_node(const std::array<int, 3>& cell) const noexcept;
  /// [any] Number of a cell.
  [[nodiscard]] std::size_t number_of(const std::array<int, 3>& cell) const noexcept;

  [[nodiscard]] Place place_of(const Vec3& point) const noexcept;
  [[nodiscard]] static Splines splines(double t) noexcept;
  /// [any] Their derivatives by t.
  [[nodiscard]] static Splines slopes(double t) noexcept;
  /// [any] The weights of a cell's nodes, the last axis fastest.
  [[nodiscard]] static std::array<double, kNodesOfCell> weights(const Place& place) noexcept;
  /// [any] The numbers of a cell's nodes, in the order of weights().
  [[nodiscard]] std::array<std::size_t, kNodesOfCell> nodes_of(const std::array<int, 3>& cell) const noexcept;

 private:
  double edge_;
  Vec3 low_;
  std::array<int, 3> cells_{};
  std::array<std::size_t, 3> strides_{};
};

/// The part of each cell that an organ fills: lines along z through every column of cells, cut exactly where
/// they cross the organ's surface. Lines of a column are spread evenly, not in rows, so that faces along the
/// axes are not counted in steps.
class CellFilling final {
 public:
  /// Integrals of x^a y^b z^c over the filled part of a cell, from 0 to 1 along each axis, at [a][b][c].
  using Moments = std::array<std::array<std::array<double, 5>, 5>, 5>;

  /// [setup] @param organ closed, outwards
  CellFilling(const CellGrid& grid, const geometry::TriangleMesh& organ);

  /// [any] The share of a cell that is filled, 0 to 1.
  [[nodiscard]] double share(const std::array<int, 3>& cell) const noexcept;
  [[nodiscard]] Moments moments(const std::array<int, 3>& cell) const noexcept;
  /// [setup] Calls use(within, share) for points of a cell's filled part, from 0 to 1 along each axis; the
  /// shares of the cell add up to share().
  template <typename Use>
  void for_each_point(const std::array<int, 3>& cell, const Use& use) const {
    constexpr int kSteps = 6;
    for_each_part(cell, [this, &use](std::size_t line, double from, double to) {
      const double step = (to - from) / kSteps;
      for (int i = 0; i < kSteps; ++i)
        use(std::array<double, 3>{places_[line].x(), places_[line].y(), from + (i + 0.5) * step},
            step / static_cast<double>(kLines));
    });
  }

 private:
  static constexpr std::size_t kLines = 64;  // of a column of cells
  struct Segment {
    double from = 0.0;  // [cells] above the grid's low end
    double to = 0.0;
  };
  // Calls use(line, from, to) for the filled parts of a cell's lines, from 0 to 1.
  template <typename Use>
  void for_each_part(const std::array<int, 3>& cell, const Use& use) const;
  [[nodiscard]] std::size_t column(int x, int y) const noexcept {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(columns_[1]) +
            static_cast<std::size_t>(y)) *
           kLines;
  }

  std::array<int, 2> columns_{};
  std::array<Eigen::Vector2d, kLines> places_;  // of the lines in each column, 0 to 1
  std::vector<std::vector<Segment>> segments_;  // per line
};

template <typename Use>
void CellFilling::for_each_part(const std::array<int, 3>& cell, const Use& use) const {
  const std::size_t first = column(cell[0], cell[1]);
  for (std::size_t l = 0; l < kLines; ++l) {
    for (const Segment& segment : segments_[first + l]) {
      const double from = std::max(0.0, segment.from - cell[2]);
      const double to = std::min(1.0, segment.to - cell[2]);
      if (from < to) use(l, from, to);
    }
  }
}

}  // namespace palpate::deform
