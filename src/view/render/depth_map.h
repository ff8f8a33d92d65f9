#pragma once
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace palpate::render {

/// Height map of how far an object reaches below a plane, over a square grid of cells, in single precision:
/// for pictures only. Four cells are computed at once (SIMD).
class DepthMap final {
 public:
  static constexpr int kSide = 90;          // cells
  static constexpr float kNothing = -1.0F;  // m: empty cell, far above the plane

  /// [setup] An empty map.
  DepthMap();

  /// [setup] Draws a triangle: sets each cell under it to the triangle's depth where that is deeper.
  /// @param a, b, c row and column [cells], depth [m] @param most largest depth that a cell gets [m]
  void add_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, float most);
  /// [setup] Surrounds the object with a slope that rises by `rise` [m] per cell. Distances come from a
  /// chamfer transform (two sweeps), at most 3 % too long.
  void add_slopes(float rise);
  /// [setup] Replaces each cell by the mean of its 3 x 3 neighbourhood, `rounds` times.
  void smooth(int rounds);

  /// [any] Depth [m] of the cell in row i and column j, 0 .. kSide - 1.
  [[nodiscard]] float at(int i, int j) const noexcept { return cells_[index(i, j)]; }

 private:
  // A margin around the map, so that neighbours always exist.
  static constexpr int kRowMargin = 3;  // two rows are read, and the rest keeps reads before the first cell
                                        // valid
  static constexpr int kLeft = 4;
  static constexpr int kStride = 96;
  [[nodiscard]] static constexpr std::size_t index(int i, int j) noexcept {
    const int cell = (i + kRowMargin) * kStride + j + kLeft;
    return static_cast<std::size_t>(cell);
  }
  void clear_margins(int i) noexcept;
  void slopes_from_rows(int i, int step, float rise) noexcept;
  void slopes_along(int i, bool forwards, float rise) noexcept;

  std::vector<float> cells_;
};

}  // namespace palpate::render
