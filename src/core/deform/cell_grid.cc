#include "core/deform/cell_grid.h"

#include <cmath>
#include <utility>

#include "core/base/index.h"

namespace palpate::deform {
namespace {

constexpr double kMargin = 0.02;  // cells between the organ's box and the grid's end

// A crossing of the organ's surface by a line along z.
struct Crossing {
  double height = 0.0;  // [cells] above the grid's low end
  int turns = 0;        // +1: the line enters the organ
};

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
  strides_[2] = 1;
  strides_[1] = static_cast<std::size_t>(cells_[2] + 2);
  strides_[0] = strides_[1] * static_cast<std::size_t>(cells_[1] + 2);
}

std::size_t CellGrid::first_node(const std::array<int, 3>& cell) const noexcept {
  return static_cast<std::size_t>(cell[0]) * stride(0) + static_cast<std::size_t>(cell[1]) * stride(1) +
         static_cast<std::size_t>(cell[2]);
}

std::size_t CellGrid::number_of(const std::array<int, 3>& cell) const noexcept {
  return (static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(cells_[1]) +
          static_cast<std::size_t>(cell[1])) *
             static_cast<std::size_t>(cells_[2]) +
         static_cast<std::size_t>(cell[2]);
}

CellGrid::Place CellGrid::place_of(const Vec3& point) const noexcept {
  Place place;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const double x = (point[axis] - low_[axis]) / edge_;
    const double cell = std::clamp(std::floor(x), 0.0, static_cast<double>(cells_[k] - 1));
    place.cell[k] = static_cast<int>(cell);
    place.within[k] = x - cell;
  }
  return place;
}

CellGrid::Splines CellGrid::splines(double t) noexcept {
  return {0.5 * (1.0 - t) * (1.0 - t), 0.5 + t - t * t, 0.5 * t * t};
}

CellGrid::Splines CellGrid::slopes(double t) noexcept { return {t - 1.0, 1.0 - 2.0 * t, t}; }

std::array<double, CellGrid::kNodesOfCell> CellGrid::weights(const Place& place) noexcept {
  const Splines x = splines(place.within[0]);
  const Splines y = splines(place.within[1]);
  const Splines z = splines(place.within[2]);
  std::array<double, kNodesOfCell> weights{};
  for (std::size_t n = 0; n < kNodesOfCell; ++n) weights[n] = x[n / 9] * y[n / 3 % 3] * z[n % 3];
  return weights;
}

std::array<std::size_t, CellGrid::kNodesOfCell> CellGrid::nodes_of(
    const std::array<int, 3>& cell) const noexcept {
  const std::size_t first = first_node(cell);
  std::array<std::size_t, kNodesOfCell> nodes{};
  for (std::size_t n = 0; n < kNodesOfCell; ++n)
    nodes[n] = first + n / 9 * stride(0) + n / 3 % 3 * stride(1) + n % 3;
  return nodes;
}

CellFilling::CellFilling(const CellGrid& grid, const geometry::TriangleMesh& organ)
    : columns_{grid.cells()[0], grid.cells()[1]} {
  // Powers of the plastic number spread points evenly in a square (Roberts 2018).
  constexpr double kPlastic = 1.32471795724474602596;
  for (std::size_t l = 0; l < kLines; ++l) {
    const double n = static_cast<double>(l) + 0.5;
    places_[l] = {std::fmod(n / kPlastic, 1.0), std::fmod(n / (kPlastic * kPlastic), 1.0)};
  }
  std::vector<std::vector<Crossing>> crossings(column(columns_[0], 0));
  for (const geometry::Triangle& t : organ.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = (organ.vertices[at(t[k])] - grid.low()) / grid.edge();
    const Eigen::Vector2d ab = (p[1] - p[0]).head<2>();
    const Eigen::Vector2d ac = (p[2] - p[0]).head<2>();
    const double area = ab.x() * ac.y() - ac.x() * ab.y();
    if (area == 0.0) continue;
    const auto range = [&](Eigen::Index axis) {
      const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
      return std::pair(std::max(0, static_cast<int>(low)),
                       std::min(columns_[static_cast<std::size_t>(axis)] - 1, static_cast<int>(high)));
    };
    const auto [first_x, last_x] = range(0);
    const auto [first_y, last_y] = range(1);
    for (int x = first_x; x <= last_x; ++x) {
      for (int y = first_y; y <= last_y; ++y) {
        for (std::size_t l = 0; l < kLines; ++l) {
          const Eigen::Vector2d q = Eigen::Vector2d(x, y) + places_[l] - p[0].head<2>();
          const double u = (q.x() * ac.y() - ac.x() * q.y()) / area;
          const double v = (ab.x() * q.y() - q.x() * ab.y()) / area;
          if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
          const double height = p[0].z() + u * (p[1].z() - p[0].z()) + v * (p[2].z() - p[0].z());
          crossings[column(x, y) + l].push_back({height, area < 0.0 ? 1 : -1});
        }
      }
    }
  }
  segments_.resize(crossings.size());
  for (std::size_t l = 0; l < crossings.size(); ++l) {
    std::vector<Crossing>& all = crossings[l];
    std::sort(all.begin(), all.end(),
              [](const Crossing& a, const Crossing& b) { return a.height < b.height; });
    int turns = 0;
    for (std::size_t c = 0; c + 1 < all.size(); ++c) {
      turns += all[c].turns;
      if (turns != 0) segments_[l].push_back({all[c].height, all[c + 1].height});
    }
  }
}

double CellFilling::share(const std::array<int, 3>& cell) const noexcept {
  double length = 0.0;
  for_each_part(cell, [&length](std::size_t, double from, double to) { length += to - from; });
  return length / static_cast<double>(kLines);
}

CellFilling::Moments CellFilling::moments(const std::array<int, 3>& cell) const noexcept {
  Moments moments{};
  for_each_part(cell, [this, &moments](std::size_t line, double from, double to) {
    std::array<double, 5> along{};
    double low = 1.0;
    double high = 1.0;
    for (std::size_t c = 0; c < 5; ++c) {
      low *= from;
      high *= to;
      along[c] = (high - low) / (static_cast<double>(c + 1) * static_cast<double>(kLines));
    }
    double x = 1.0;
    for (std::size_t a = 0; a < 5; ++a, x *= places_[line].x()) {
      double xy = x;
      for (std::size_t b = 0; b < 5; ++b, xy *= places_[line].y())
        for (std::size_t c = 0; c < 5; ++c) moments[a][b][c] += xy * along[c];
    }
  });
  return moments;
}

}  // namespace palpate::deform
