// The stiffness of an organ in cells (body_compliance.h), piece by piece.
//
// Whole cells have the same stiffness, computed once. Cut ones are integrated over the part inside the organ,
// with 1e-4 of the stiffness outside, so that no node is loose. The held surface is a layer of stiff springs;
// each small part of it adds the products of its cell's splines. What is held inside has springs by volume.

#include "core/deform/body_stiffness.h"

#include <algorithm>
#include <array>

#include "core/base/index.h"
#include "core/deform/half_space.h"
#include "core/deform/surface_parts.h"

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

constexpr double kWhole = 1.0 - 1e-9;  // share of a cell that counts as filled

constexpr auto kNodes = static_cast<Index>(CellGrid::kNodesOfCell);

// Coefficients of a polynomial, from the constant on.
using Polynomial = std::array<double, 5>;

// Products of two splines of one axis, or of their slopes: [first is a slope][second is one][first][second].
using AxisProducts = std::array<std::array<std::array<std::array<Polynomial, 3>, 3>, 2>, 2>;

AxisProducts axis_products() {
  constexpr std::array<std::array<std::array<double, 3>, 3>, 2> kSplines = {
      {{{{0.5, -1.0, 0.5}, {0.5, 1.0, -1.0}, {0.0, 0.0, 0.5}}},
       {{{-1.0, 1.0, 0.0}, {1.0, -2.0, 0.0}, {0.0, 1.0, 0.0}}}}};
  AxisProducts products{};
  for (std::size_t first = 0; first < 2; ++first)
    for (std::size_t second = 0; second < 2; ++second)
      for (std::size_t p = 0; p < 3; ++p)
        for (std::size_t q = 0; q < 3; ++q)
          for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b)
              products[first][second][p][q][a + b] += kSplines[first][p][a] * kSplines[second][q][b];
  return products;
}

// Integrals of products of the nodes' slopes over a cell with these moments: entry (27 i + a, 27 j + b) is
// that of slope i of node a times slope j of node b, times the cell's edge. One axis is summed after the
// other.
MatrixXd slope_products(const CellPieces::Moments& moments) {
  static const AxisProducts kProducts = axis_products();
  MatrixXd result(3 * kNodes, 3 * kNodes);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const auto of_axis = [ i, j ](std::size_t axis) -> const auto& {
        return kProducts[axis == i ? 1 : 0][axis == j ? 1 : 0];
      };
      for (std::size_t z = 0; z < 9; ++z) {
        std::array<Polynomial, 5> by_z{};  // coefficients by x and y
        for (std::size_t a = 0; a < 5; ++a)
          for (std::size_t b = 0; b < 5; ++b)
            for (std::size_t c = 0; c < 5; ++c) by_z[a][b] += of_axis(2)[z / 3][z % 3][c] * moments[a][b][c];
        for (std::size_t y = 0; y < 9; ++y) {
          Polynomial by_y{};  // by x
          for (std::size_t a = 0; a < 5; ++a)
            for (std::size_t b = 0; b < 5; ++b) by_y[a] += of_axis(1)[y / 3][y % 3][b] * by_z[a][b];
          for (std::size_t x = 0; x < 9; ++x) {
            double sum = 0.0;
            for (std::size_t a = 0; a < 5; ++a) sum += of_axis(0)[x / 3][x % 3][a] * by_y[a];
            const auto row = static_cast<Index>(27 * i + 9 * (x / 3) + 3 * (y / 3) + z / 3);
            const auto column = static_cast<Index>(27 * j + 9 * (x % 3) + 3 * (y % 3) + z % 3);
            result(row, column) = sum;
            result(column, row) = sum;
          }
        }
      }
    }
  }
  return result;
}

CellPieces::Moments moments_of_whole_cell() {
  CellPieces::Moments moments{};
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b)
      for (std::size_t c = 0; c < 5; ++c)
        moments[a][b][c] =
            1.0 / (static_cast<double>(a + 1) * static_cast<double>(b + 1) * static_cast<double>(c + 1));
  return moments;
}

}  // namespace

BodyStiffness::BodyStiffness(const CellPieces& pieces, const geometry::TriangleMesh& organ,
                             const geometry::HeldSurface& held)
    : pieces_(pieces), whole_(slope_products(moments_of_whole_cell())) {
  const double edge = pieces_.cells().whole().edge();
  const auto add_spring = [this](const CellPieces::Place& place, double stiffness) {
    const auto weights = CellGrid::weights(place.within);
    const Eigen::Map<const Eigen::Matrix<double, kNodes, 1>> w(weights.data());
    springs_.try_emplace(place.piece, Products::Zero()).first->second += stiffness * w * w.transpose();
  };
  for_each_part(organ, edge / kPartsOfCell, [&](const Vec3& point, const Vec3& area) {
    if (held.holds(point, area))
      add_spring(pieces_.place_of(point, area.normalized()), kHeldStiffness / edge * area.norm());
  });
  for (std::size_t piece = 0; piece < pieces_.pieces().size(); ++piece) {
    const double edge_here = pieces_.edge_of(piece);
    const auto cell = pieces_.cells().cell_of(pieces_.pieces()[piece].cell);
    pieces_.for_each_point(piece, [&](const std::array<double, 3>& within, double share) {
      const Vec3 point = pieces_.cells().whole().low() +
                         edge_here * Vec3(cell[0] + within[0], cell[1] + within[1], cell[2] + within[2]);
      if (held.holds_inside(point))
        add_spring({piece, within}, kHeldInside * share * edge_here * edge_here * edge_here / (edge * edge));
    });
  }
}

MatrixXd BodyStiffness::of_splines(std::size_t piece) const {
  constexpr double kLame = kPoisson / ((1.0 + kPoisson) * (1.0 - 2.0 * kPoisson));
  constexpr double kShear = 1.0 / (2.0 * (1.0 + kPoisson));
  MatrixXd products = whole_;
  if (pieces_.share(piece) < kWhole) products = slope_products(pieces_.moments(piece)) + kOutside * whole_;
  MatrixXd matrix(3 * kNodes, 3 * kNodes);
  for (Index a = 0; a < kNodes; ++a) {
    for (Index b = 0; b < kNodes; ++b) {
      Matrix3d m;
      for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j) m(i, j) = products(i * kNodes + a, j * kNodes + b);
      matrix.block<3, 3>(3 * a, 3 * b) = pieces_.edge_of(piece) * (kLame * m + kShear * m.transpose() +
                                                                   kShear * m.trace() * Matrix3d::Identity());
    }
  }
  if (const auto held = springs_.find(piece); held != springs_.end())
    for (Index a = 0; a < kNodes; ++a)
      for (Index b = 0; b < kNodes; ++b)
        matrix.block<3, 3>(3 * a, 3 * b) += held->second(a, b) * Matrix3d::Identity();
  return matrix;
}

std::vector<std::int32_t> BodyStiffness::nodes_of(std::size_t piece) const {
  std::vector<std::int32_t> nodes;
  for (const std::int32_t spline : pieces_.pieces()[piece].splines)
    pieces_.for_each_term(spline, [&nodes](std::int32_t node, float) { nodes.push_back(node); });
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

BodyStiffness::OfPiece BodyStiffness::of(std::size_t piece) const {
  const CellPieces::Splines& splines = pieces_.pieces()[piece].splines;
  const MatrixXd matrix = of_splines(piece);
  OfPiece result{nodes_of(piece), {}};
  const std::vector<std::int32_t>& nodes = result.nodes;
  // Sums over the rows' terms first, then over the columns'.
  MatrixXd rows = MatrixXd::Zero(3 * static_cast<Index>(nodes.size()), 3 * kNodes);
  result.matrix.setZero(rows.rows(), rows.rows());
  for (std::size_t s = 0; s < splines.size(); ++s) {
    pieces_.for_each_term(splines[s], [&](std::int32_t node, float weight) {
      const Index n = std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
      rows.middleRows<3>(3 * n) +=
          static_cast<double>(weight) * matrix.middleRows<3>(3 * static_cast<Index>(s));
    });
  }
  for (std::size_t s = 0; s < splines.size(); ++s) {
    pieces_.for_each_term(splines[s], [&](std::int32_t node, float weight) {
      const Index n = std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
      result.matrix.middleCols<3>(3 * n) +=
          static_cast<double>(weight) * rows.middleCols<3>(3 * static_cast<Index>(s));
    });
  }
  return result;
}

std::vector<std::size_t> BlockSum::first_rows(const std::vector<std::size_t>& planes) {
  std::vector<std::size_t> first;
  for (std::size_t plane = 0; plane + 1 < planes.size(); plane += 2)
    if (planes[std::min(plane + 2, planes.size() - 1)] > planes[plane])  // not at the end of a thin organ
      first.push_back(3 * planes[plane]);
  first.push_back(3 * planes.back());
  return first;
}

BlockSum::BlockSum(const std::vector<std::size_t>& planes) {
  matrix_.first = first_rows(planes);
  for (std::size_t k = 0; k + 1 < matrix_.first.size(); ++k) {
    block_of_.resize(matrix_.first[k + 1] / 3, k);
    matrix_.diagonal.emplace_back(matrix_.size(k) * matrix_.size(k));
    if (k + 2 < matrix_.first.size()) matrix_.coupling.emplace_back(matrix_.size(k + 1) * matrix_.size(k));
  }
}

void BlockSum::add(std::int32_t row, std::int32_t column, const Matrix3d& stiffness) {
  const std::size_t block = block_of_[palpate::at(column)];
  const std::size_t block_of_row = block_of_[palpate::at(row)];
  std::vector<double>& to = block_of_row == block ? matrix_.diagonal[block] : matrix_.coupling[block];
  const std::size_t height = matrix_.size(block_of_row);
  const std::size_t first = 3 * palpate::at(row) - matrix_.first[block_of_row] +
                            height * (3 * palpate::at(column) - matrix_.first[block]);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r)
      to[first + height * c + r] += stiffness(static_cast<Index>(r), static_cast<Index>(c));
}

}  // namespace palpate::deform
