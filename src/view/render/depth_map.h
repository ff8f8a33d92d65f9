#pragma once
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace palpate::render {

/// How deep something reaches below a plane, over a square of cells; four cells are worked on at once.
/// Columns and depths in single precision: for pictures only.
class DepthMap final {
 public:
  static constexpr int kSide = 90;          // cells
  static constexpr float kNothing = -1.0F;  // m: far above any plane

  /// [setup] With nothing in it.
  DepthMap();

  /// [setup] Lowers the cells under a triangle to its depth, where that is deeper.
  /// @param a, b, c row and column in cells, depth [m] @param most no cell gets deeper than this [m]
  void add_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, float most);
  /// [setup] Around everything a slope that rises by `rise` [m] a cell. Distances are found by two sweeps
  /// with a knight's moves (a chamfer map), at most 3 % too long.
  void add_slopes(float rise);
  /// [setup] Each cell the mean of 3 x 3, `rounds` times over.
  void even_out(int rounds);

  /// [any] Depth [m] of the cell in row i and column j, 0 .. kSide - 1.
  [[nodiscard]] float at(int i, int j) const noexcept { return cells_[place(i, j)]; }

 private:
  // A margin around the map saves asking whether a neighbour is there.
  static constexpr int kRowMargin = 3;  // two are read, and a few cells before them
  static constexpr int kLeft = 4;
  static constexpr int kStride = 96;
  [[nodiscard]] static constexpr std::size_t place(int i, int j) noexcept {
    const int cell = (i + kRowMargin) * kStride + j + kLeft;
    return static_cast<std::size_t>(cell);
  }
  void clear_margins(int i) noexcept;
  void slopes_from_rows(int i, int step, float rise) noexcept;
  void slopes_along(int i, bool forwards, float rise) noexcept;

  std::vector<float> cells_;
};

}  // namespace palpate::render
