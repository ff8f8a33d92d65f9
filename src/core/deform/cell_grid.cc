#include "core/deform/cell_grid.h"

#include <cmath>

namespace palpate::deform {
namespace {

constexpr double kMargin = 0.02;  // cells between the organ's box and the grid's end

}  // namespace

CellGrid::CellGrid(const geometry::Bounds& box, double edge) : edge_(edge) {
  const Vec3 size = box.size();
  Vec3 whole;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    cells_[k] = std::max(1, static_cast<int>(std::ceil(size[axis] / edge + kMargin)));
    whole[axis] = edge * cells_[k];
  }
  low_ = box.middle() - 0.5 * whole;
}

CellGrid CellGrid::halved() const {
  CellGrid halves;
  halves.edge_ = 0.5 * edge_;
  halves.low_ = low_;
  for (std::size_t k = 0; k < 3; ++k) halves.cells_[k] = 2 * cells_[k];
  return halves;
}

std::size_t CellGrid::number_of(const std::array<int, 3>& cell) const noexcept {
  return (static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(cells_[1]) +
          static_cast<std::size_t>(cell[1])) *
             static_cast<std::size_t>(cells_[2]) +
         static_cast<std::size_t>(cell[2]);
}

std::array<int, 3> CellGrid::cell_of(std::size_t number) const noexcept {
  const auto across_y = static_cast<std::size_t>(cells_[1]);
  const auto across_z = static_cast<std::size_t>(cells_[2]);
  return {static_cast<int>(number / across_z / across_y), static_cast<int>(number / across_z % across_y),
          static_cast<int>(number % across_z)};
}

CellGrid::Place CellGrid::place_of(const Vec3& point) const noexcept {
  Place place;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const double x = (point[axis] - low_[axis]) / edge_;
    place.cell[k] = static_cast<int>(std::clamp(x, 0.0, static_cast<double>(cells_[k] - 1)));
    place.within[k] = x - place.cell[k];
  }
  return place;
}

CellGrid::Splines CellGrid::splines(double t) noexcept {
  return {0.5 * (1.0 - t) * (1.0 - t), 0.5 + t - t * t, 0.5 * t * t};
}

std::array<double, CellGrid::kNodesOfCell> CellGrid::weights(const std::array<double, 3>& within) noexcept {
  const Splines x = splines(within[0]);
  const Splines y = splines(within[1]);
  const Splines z = splines(within[2]);
  std::array<double, kNodesOfCell> weights{};
  for (std::size_t n = 0; n < kNodesOfCell; ++n) weights[n] = x[n / 9] * y[n / 3 % 3] * z[n % 3];
  return weights;
}

}  // namespace palpate::deform
