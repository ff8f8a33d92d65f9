#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "palpate/mesh.h"

namespace palpate::deform {

/// Calls use(cell) for all cells from `first` to `last`, the last axis fastest.
template <typename Use>
void for_each_cell(const std::array<int, 3>& first, const std::array<int, 3>& last, const Use& use) {
  std::array<int, 3> cell{};
  for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) use(cell);
}

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

  /// [setup] The same cells, each cut into eight.
  [[nodiscard]] CellGrid halved() const;

  [[nodiscard]] double edge() const noexcept { return edge_; }
  [[nodiscard]] const std::array<int, 3>& cells() const noexcept { return cells_; }
  [[nodiscard]] const Vec3& low() const noexcept { return low_; }
  [[nodiscard]] std::size_t cell_count() const noexcept {
    return static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
           static_cast<std::size_t>(cells_[2]);
  }
  /// [any] Number of a cell, the last axis fastest.
  [[nodiscard]] std::size_t number_of(const std::array<int, 3>& cell) const noexcept;
  [[nodiscard]] std::array<int, 3> cell_of(std::size_t number) const noexcept;

  [[nodiscard]] Place place_of(const Vec3& point) const noexcept;
  [[nodiscard]] static Splines splines(double t) noexcept;
  /// [any] The weights of a cell's nodes, the last axis fastest. @param within as in a place
  [[nodiscard]] static std::array<double, kNodesOfCell> weights(const std::array<double, 3>& within) noexcept;

 private:
  CellGrid() = default;

  double edge_ = 0.0;
  Vec3 low_;
  std::array<int, 3> cells_{};
};

}  // namespace palpate::deform
