// How a whole organ moves when its surface is pressed: a linear elastic body that a support holds.
//
// The organ is cut into cubic cells. Over each lie 27 quadratic B-splines, and the displacement is their sum
// with one vector a node:
//
//        +-----+-----+-----+        whole cells: the same stiffness, computed once
//        |  ..-+-----+-..  |        cut cells: integrated over the part inside the organ
//        +-'---+-----+---'-+        (CellFilling), with 1e-4 of the stiffness outside, so that
//        |'    |     |    '|        no node is loose
//        +-----+-----+-----+
//
// The splines' slopes are continuous, so about a thousand nodes describe how an organ bends and bulges. Close
// to a contact, where cells are too coarse, the half-space's closed form corrects the field
// (response_field.h).
//
// 1. The largest number of cells is chosen that needs at most kMostNodes nodes.
// 2. The stiffness matrix is assembled cell by cell. The held surface is a layer of stiff springs; each
//    small part of it adds the products of its cell's splines.
// 3. Nodes are ordered by planes across the longest axis of the grid. Two planes make a block, and a block
//    couples with its two neighbours only.
// 4. The inverse (block_inverse.h), one column a node and direction, is the compliance: displacements under
//    unit forces. All forces of a picture then cost one sum over the loaded nodes' columns.
//
// Sources: finite cells (Parvizian, Duester and Rank 2007); B-splines as elements (Hoellig 2003).

#include "core/deform/body_compliance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "core/base/content_hash.h"
#include "core/base/index.h"
#include "core/deform/half_space.h"
#include "core/deform/surface_parts.h"
#include "palpate/error.h"

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

#ifdef __EMSCRIPTEN__  // has no vectors, and the page waits for the result
constexpr std::size_t kMostNodes = 400;
#else
constexpr std::size_t kMostNodes = 960;  // half their inverse has 9 MB
#endif
// Rises when the same organ and support get another response.
constexpr std::uint64_t kResponseVersion = 1;
constexpr double kFewestCells = 3.0;  // along the longest extent
constexpr double kMostCells = 60.0;
constexpr int kSteps = 7;                // of the search for the finest grid
constexpr double kWhole = 1.0 - 1e-9;    // share of a cell that counts as filled
constexpr double kOutside = 1e-4;        // stiffness outside the organ in cut cells
constexpr double kHeldInside = 15.0;     // the same of what is held inside, by the square of a cell
constexpr double kHeldStiffness = 15.0;  // of the held surface's springs, times Young's modulus / cell

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
MatrixXd slope_products(const CellFilling::Moments& moments) {
  static const AxisProducts kProducts = axis_products();
  MatrixXd result(3 * kNodes, 3 * kNodes);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
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
            const std::size_t row = 27 * i + 9 * (x / 3) + 3 * (y / 3) + z / 3;
            const std::size_t column = 27 * j + 9 * (x % 3) + 3 * (y % 3) + z % 3;
            result(static_cast<Index>(row), static_cast<Index>(column)) = sum;
          }
        }
      }
    }
  }
  return result;
}

CellFilling::Moments moments_of_whole_cell() {
  CellFilling::Moments moments{};
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b)
      for (std::size_t c = 0; c < 5; ++c)
        moments[a][b][c] =
            1.0 / (static_cast<double>(a + 1) * static_cast<double>(b + 1) * static_cast<double>(c + 1));
  return moments;
}

// Cells that the organ or its surface reaches.
std::vector<std::array<int, 3>> cells_of(const CellGrid& grid, const CellFilling& filling,
                                         const geometry::TriangleMesh& organ) {
  std::vector<bool> touched(static_cast<std::size_t>(grid.cells()[0]) *
                            static_cast<std::size_t>(grid.cells()[1]) *
                            static_cast<std::size_t>(grid.cells()[2]));
  for_each_part(organ, grid.edge() / kPartsOfCell, [&](const Vec3& point, const Vec3&) {
    touched[grid.number_of(grid.place_of(point).cell)] = true;
  });
  std::vector<std::array<int, 3>> cells;
  std::array<int, 3> cell{};
  for (cell[0] = 0; cell[0] < grid.cells()[0]; ++cell[0])
    for (cell[1] = 0; cell[1] < grid.cells()[1]; ++cell[1])
      for (cell[2] = 0; cell[2] < grid.cells()[2]; ++cell[2])
        if (touched[grid.number_of(cell)] || filling.share(cell) > 0.0) cells.push_back(cell);
  return cells;
}

std::size_t nodes_under(const CellGrid& grid, const std::vector<std::array<int, 3>>& cells) {
  std::vector<bool> used(grid.nodes());
  for (const auto& cell : cells)
    for (const std::size_t node : grid.nodes_of(cell)) used[node] = true;
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

// Assembles and inverts the stiffness of one organ.
class Body {
 public:
  Body(const geometry::TriangleMesh& organ, BodyCompliance& body)
      : body_(body), grid_(body.grid), organ_(organ), filling_(grid_, organ) {}

  void number_nodes();
  void add_cells();
  void add_support(const geometry::HeldSurface& held);
  // @return false when nothing holds the organ
  [[nodiscard]] bool invert();
  // Takes an inverse of the cache instead. @return false when it is of other blocks
  [[nodiscard]] bool take(contact::ResponseArrays arrays);

 private:
  void add_cell(const std::array<int, 3>& cell);
  // Adds the coupling of two nodes; the one with the larger number is the row.
  void add(std::int32_t row, std::int32_t column, const Matrix3d& stiffness);

  BodyCompliance& body_;
  const CellGrid& grid_;
  const geometry::TriangleMesh& organ_;
  CellFilling filling_;
  std::vector<std::array<int, 3>> cells_;
  const MatrixXd whole_ = slope_products(moments_of_whole_cell());
  BlockMatrix matrix_;
  std::vector<std::size_t> block_of_;  // per unknown node
};

void Body::number_nodes() {
  cells_ = cells_of(grid_, filling_, organ_);
  std::vector<bool> used(grid_.nodes());
  for (const auto& cell : cells_)
    for (const std::size_t node : grid_.nodes_of(cell)) used[node] = true;
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (grid_.cells()[axis] > grid_.cells()[longest]) longest = axis;
  const std::size_t stride = grid_.stride(longest);
  const auto planes = static_cast<std::size_t>(grid_.cells()[longest] + 2);
  body_.unknown_of.assign(grid_.nodes(), -1);
  for (std::size_t plane = 0; plane < planes; ++plane) {
    const std::size_t before = body_.nodes.size();
    if (plane % 2 == 0) matrix_.first.push_back(3 * before);
    for (std::size_t node = 0; node < used.size(); ++node) {
      if (!used[node] || node / stride % planes != plane) continue;
      body_.unknown_of[node] = static_cast<std::int32_t>(body_.nodes.size());
      body_.nodes.push_back(static_cast<std::int32_t>(node));
      block_of_.push_back(plane / 2);
    }
  }
  matrix_.first.push_back(3 * body_.nodes.size());
}

void Body::add_cells() {
  for (std::size_t k = 0; k + 1 < matrix_.first.size(); ++k) {
    matrix_.diagonal.emplace_back(matrix_.size(k) * matrix_.size(k));
    if (k + 2 < matrix_.first.size()) matrix_.coupling.emplace_back(matrix_.size(k + 1) * matrix_.size(k));
  }
  for (const auto& cell : cells_) add_cell(cell);
}

void Body::add(std::int32_t row, std::int32_t column, const Matrix3d& stiffness) {
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

void Body::add_cell(const std::array<int, 3>& cell) {
  constexpr double kLame = kPoisson / ((1.0 + kPoisson) * (1.0 - 2.0 * kPoisson));
  constexpr double kShear = 1.0 / (2.0 * (1.0 + kPoisson));
  MatrixXd products = whole_;
  if (filling_.share(cell) < kWhole) products = slope_products(filling_.moments(cell)) + kOutside * whole_;
  const auto nodes = grid_.nodes_of(cell);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const std::int32_t row = body_.unknown_of[nodes[a]];
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      const std::int32_t column = body_.unknown_of[nodes[b]];
      if (row < column) continue;
      Matrix3d m;
      for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j)
          m(i, j) = products(i * kNodes + static_cast<Index>(a), j * kNodes + static_cast<Index>(b));
      add(row, column,
          grid_.edge() * (kLame * m + kShear * m.transpose() + kShear * m.trace() * Matrix3d::Identity()));
    }
  }
}

void Body::add_support(const geometry::HeldSurface& held) {
  using Products = Eigen::Matrix<double, kNodes, kNodes>;
  std::map<std::array<int, 3>, Products> cells;
  for_each_part(organ_, grid_.edge() / kPartsOfCell, [&](const Vec3& point, const Vec3& area) {
    if (!held.holds(point, area)) return;
    const CellGrid::Place place = grid_.place_of(point);
    const auto weights = CellGrid::weights(place);
    const Eigen::Map<const Eigen::Matrix<double, kNodes, 1>> w(weights.data());
    cells.try_emplace(place.cell, Products::Zero()).first->second += area.norm() * w * w.transpose();
  });
  const double inside = kHeldInside / kHeldStiffness * grid_.edge() * grid_.edge();
  for (const auto& cell : cells_) {
    filling_.for_each_point(cell, [&](const std::array<double, 3>& within, double share) {
      const Vec3 point =
          grid_.low() + grid_.edge() * Vec3(cell[0] + within[0], cell[1] + within[1], cell[2] + within[2]);
      if (!held.holds_inside(point)) return;
      const auto weights = CellGrid::weights({cell, within});
      const Eigen::Map<const Eigen::Matrix<double, kNodes, 1>> w(weights.data());
      cells.try_emplace(cell, Products::Zero()).first->second += inside * share * w * w.transpose();
    });
  }
  for (const auto& [cell, products] : cells) {
    const auto nodes = grid_.nodes_of(cell);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        const std::int32_t row = body_.unknown_of[nodes[a]];
        const std::int32_t column = body_.unknown_of[nodes[b]];
        if (row >= column)
          add(row, column,
              kHeldStiffness / grid_.edge() * products(static_cast<Index>(a), static_cast<Index>(b)) *
                  Matrix3d::Identity());
      }
    }
  }
}

bool Body::invert() {
  std::optional<BlockInverse> inverse = BlockInverse::of(std::move(matrix_));
  if (inverse) body_.compliance = std::move(*inverse);
  return inverse.has_value();
}

bool Body::take(contact::ResponseArrays arrays) {
  std::optional<BlockInverse> inverse =
      BlockInverse::of(matrix_.first, std::move(arrays.scale), std::move(arrays.entries));
  if (inverse) body_.compliance = std::move(*inverse);
  return inverse.has_value();
}

// Hash of everything that a response depends on.
ContentHash response_key(const geometry::TriangleMesh& organ, const geometry::Support& support) {
  ContentHasher hasher;
  hasher.add(kResponseVersion).add(kMostNodes).add(kPoisson);
  hasher.add(kOutside).add(kHeldInside).add(kHeldStiffness);
  hasher.add(std::span<const Vec3>(organ.vertices)).add(std::span<const geometry::Triangle>(organ.triangles));
  hasher.add(support.bed.has_value()).add(support.faces.has_value()).add(support.attachments.size());
  if (support.bed) hasher.add(support.bed->direction).add(support.bed->share);
  if (support.faces) hasher.add(support.faces->away_from);
  for (const auto* list : {&support.attachments, &support.painted})
    for (const geometry::Attachment& one : *list) hasher.add(one.point).add(one.radius);
  return hasher.hash();
}

// The compliance that a cache has kept; empty when it has none that is possible.
std::optional<BodyCompliance> kept_compliance(const contact::OrganStore& store, const ContentHash& key,
                                              const geometry::TriangleMesh& organ) {
  std::optional<contact::ResponseArrays> arrays = store.load_response(key);
  const geometry::Bounds box = geometry::bounds(organ);
  if (!arrays) return std::nullopt;
  const double cells = box.size().maxCoeff() / arrays->cell_edge;  // along the longest extent
  if (!(cells > 0.5 * kFewestCells && cells < 2.0 * kMostCells)) return std::nullopt;
  BodyCompliance made{CellGrid(box, arrays->cell_edge), {}, {}, {}};
  Body body(organ, made);
  body.number_nodes();
  if (!body.take(std::move(*arrays))) return std::nullopt;
  return made;
}

}  // namespace

CellGrid finest_grid(const geometry::TriangleMesh& organ) {
  const geometry::Bounds box = geometry::bounds(organ);
  double most = box.size().maxCoeff() / kFewestCells;
  double least = box.size().maxCoeff() / kMostCells;
  CellGrid best(box, most);
  for (int step = 0; step < kSteps; ++step) {
    const double edge = std::sqrt(least * most);
    const CellGrid next(box, edge);
    const bool fits = nodes_under(next, cells_of(next, CellFilling(next, organ), organ)) <= kMostNodes;
    (fits ? most : least) = edge;
    if (fits) best = next;
  }
  return best;
}

BodyCompliance body_compliance(const geometry::TriangleMesh& organ, const geometry::Support& support,
                               const contact::OrganStore* store) {
  const ContentHash key = store != nullptr ? response_key(organ, support) : ContentHash{};
  if (store != nullptr) {
    if (std::optional<BodyCompliance> kept = kept_compliance(*store, key, organ)) return *std::move(kept);
  }
  const geometry::HeldSurface held(support, organ);
  geometry::check_support(support, organ);
  BodyCompliance made{finest_grid(organ), {}, {}, {}};
  Body body(organ, made);
  body.number_nodes();
  body.add_cells();
  body.add_support(held);
  if (!body.invert())
    throw InputError("support: holds too little of the organ's surface, so the organ would turn away");
  if (store != nullptr)
    store->store_response(key, {made.grid.edge(), made.compliance.scale(), made.compliance.entries()});
  return made;
}

}  // namespace palpate::deform
