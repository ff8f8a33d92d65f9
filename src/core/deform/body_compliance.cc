// How a whole organ moves when its surface is pressed: a linear elastic body that a support holds.
//
// The organ is cut into cubic cells. Over each lie 27 quadratic B-splines, and the displacement is their sum
// with one vector a node:
//
//        +-----+-----+-----+        whole cells: the same stiffness, computed once
//        |  ..-+-----+-..  |        cut cells: integrated over the part inside the organ
//        +-'---+-----+---'-+        (cell_pieces.h), with 1e-4 of the stiffness outside, so that
//        |'    |     |    '|        no node is loose
//        +-----+-----+-----+
//
// The splines' slopes are continuous, so about a thousand nodes describe how an organ bends and bulges. Close
// to a contact, where cells are too coarse, the half-space's closed form corrects the field
// (response_field.h).
//
// 1. The largest number of cells is chosen that needs at most kMostNodes nodes.
// 2. The stiffness matrix is assembled cell by cell. The held surface is a layer of stiff springs; each
//    small part of it adds the products of its cell's splines. At the rim of an attachment the strain has no
//    bound, and an organ that hangs on a vessel would sway too little. So cells in which an attachment ends
//    are cut into eight.
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
constexpr std::uint64_t kResponseVersion = 3;
constexpr double kFewestCells = 3.0;  // along the longest extent
constexpr double kMostCells = 60.0;
constexpr int kSteps = 6;                // at most, of the search for the finest cells
constexpr double kFineEnough = 1.02;     // between the finest cells that are known to do and too fine ones
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
MatrixXd slope_products(const CellPieces::Moments& moments) {
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

CellPieces::Moments moments_of_whole_cell() {
  CellPieces::Moments moments{};
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b)
      for (std::size_t c = 0; c < 5; ++c)
        moments[a][b][c] =
            1.0 / (static_cast<double>(a + 1) * static_cast<double>(b + 1) * static_cast<double>(c + 1));
  return moments;
}

// Assembles and inverts the stiffness of one organ.
class Body {
 public:
  explicit Body(BodyCompliance& body);

  void add_pieces();
  void add_support(const geometry::TriangleMesh& organ, const geometry::HeldSurface& held);
  // @return false when nothing holds the organ
  [[nodiscard]] bool invert();
  // Takes an inverse of the cache instead. @return false when it is of other blocks
  [[nodiscard]] bool take(contact::ResponseArrays arrays);

 private:
  [[nodiscard]] MatrixXd stiffness(std::size_t piece) const;
  // Adds a symmetric matrix of 3 x 3 blocks between the splines of a piece: entry (3 first + i, 3 second +
  // j).
  void add(std::size_t piece, const MatrixXd& matrix);
  // Adds the coupling of two nodes; the one with the larger number is the row.
  void add(std::int32_t row, std::int32_t column, const Matrix3d& stiffness);

  BodyCompliance& body_;
  const CellPieces& pieces_;
  const MatrixXd whole_ = slope_products(moments_of_whole_cell());
  BlockMatrix matrix_;
  std::vector<std::size_t> block_of_;  // per node
};

Body::Body(BodyCompliance& body) : body_(body), pieces_(body.pieces) {
  const std::vector<std::size_t>& planes = pieces_.planes();
  for (std::size_t plane = 0; plane + 1 < planes.size(); plane += 2) {
    const std::size_t end = planes[std::min(plane + 2, planes.size() - 1)];
    if (end == planes[plane]) continue;  // without nodes, as at the end of a thin organ
    block_of_.resize(end, matrix_.first.size());
    matrix_.first.push_back(3 * planes[plane]);
  }
  matrix_.first.push_back(3 * pieces_.nodes());
}

void Body::add_pieces() {
  for (std::size_t k = 0; k + 1 < matrix_.first.size(); ++k) {
    matrix_.diagonal.emplace_back(matrix_.size(k) * matrix_.size(k));
    if (k + 2 < matrix_.first.size()) matrix_.coupling.emplace_back(matrix_.size(k + 1) * matrix_.size(k));
  }
  for (std::size_t piece = 0; piece < pieces_.pieces().size(); ++piece) add(piece, stiffness(piece));
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

MatrixXd Body::stiffness(std::size_t piece) const {
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
  return matrix;
}

void Body::add(std::size_t piece, const MatrixXd& matrix) {
  const CellPieces::Splines& splines = pieces_.pieces()[piece].splines;
  std::vector<std::int32_t> nodes;
  for (const std::int32_t spline : splines)
    pieces_.for_each_term(spline, [&nodes](std::int32_t node, float) { nodes.push_back(node); });
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  // Sums over the rows' terms first, then over the columns'.
  MatrixXd rows = MatrixXd::Zero(3 * static_cast<Index>(nodes.size()), 3 * kNodes);
  MatrixXd sums = MatrixXd::Zero(rows.rows(), rows.rows());
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
      sums.middleCols<3>(3 * n) +=
          static_cast<double>(weight) * rows.middleCols<3>(3 * static_cast<Index>(s));
    });
  }
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b)
      add(nodes[a], nodes[b], sums.block<3, 3>(3 * static_cast<Index>(a), 3 * static_cast<Index>(b)));
}

void Body::add_support(const geometry::TriangleMesh& organ, const geometry::HeldSurface& held) {
  using Products = Eigen::Matrix<double, kNodes, kNodes>;
  std::map<std::size_t, Products> springs;  // by piece
  const double edge = pieces_.cells().whole().edge();
  const auto add_spring = [&springs](const CellPieces::Place& place, double stiffness) {
    const auto weights = CellGrid::weights(place.within);
    const Eigen::Map<const Eigen::Matrix<double, kNodes, 1>> w(weights.data());
    springs.try_emplace(place.piece, Products::Zero()).first->second += stiffness * w * w.transpose();
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
  for (const auto& [piece, products] : springs) {
    MatrixXd matrix = MatrixXd::Zero(3 * kNodes, 3 * kNodes);
    for (Index a = 0; a < kNodes; ++a)
      for (Index b = 0; b < kNodes; ++b)
        matrix.block<3, 3>(3 * a, 3 * b) = products(a, b) * Matrix3d::Identity();
    add(piece, matrix);
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

// What the attachments alone hold; empty without any.
std::optional<geometry::HeldSurface> attached_surface(const geometry::TriangleMesh& organ,
                                                      const geometry::Support& support) {
  if (support.attachments.empty()) return std::nullopt;
  geometry::Support attachments;
  attachments.attachments = support.attachments;
  return geometry::HeldSurface(attachments, organ);
}

// The compliance that a cache has kept; empty when it has none that is possible.
std::optional<BodyCompliance> kept_compliance(const contact::OrganStore& store, const ContentHash& key,
                                              const geometry::TriangleMesh& organ,
                                              const geometry::Support& support) {
  std::optional<contact::ResponseArrays> arrays = store.load_response(key);
  const geometry::Bounds box = geometry::bounds(organ);
  if (!arrays) return std::nullopt;
  const double cells = box.size().maxCoeff() / arrays->cell_edge;  // along the longest extent
  if (!(cells > 0.5 * kFewestCells && cells < 2.0 * kMostCells)) return std::nullopt;
  const std::optional<geometry::HeldSurface> attached = attached_surface(organ, support);
  BodyCompliance made{CellPieces(CellGrid(box, arrays->cell_edge), organ, attached), {}};
  if (!Body(made).take(std::move(*arrays))) return std::nullopt;
  return made;
}

}  // namespace

CellPieces finest_pieces(const geometry::TriangleMesh& organ, const geometry::Support& support) {
  const std::optional<geometry::HeldSurface> attached = attached_surface(organ, support);
  const geometry::Bounds box = geometry::bounds(organ);
  double most = box.size().maxCoeff() / kFewestCells;
  double least = box.size().maxCoeff() / kMostCells;
  CellPieces best(CellGrid(box, most), organ, attached);
  double nodes = static_cast<double>(best.nodes());
  double edge = most;
  for (int step = 0; step < kSteps && most > kFineEnough * least; ++step) {
    // Where the nodes would fit if their number went with the square of 1 / edge.
    edge = std::clamp(edge * std::sqrt(nodes / static_cast<double>(kMostNodes)), kFineEnough * least,
                      most / kFineEnough);
    CellPieces next(CellGrid(box, edge), organ, attached);
    nodes = static_cast<double>(next.nodes());
    const bool fits = next.nodes() <= kMostNodes;
    (fits ? most : least) = edge;
    if (fits) best = std::move(next);
  }
  return best;
}

BodyCompliance body_compliance(const geometry::TriangleMesh& organ, const geometry::Support& support,
                               const contact::OrganStore* store) {
  const ContentHash key = store != nullptr ? response_key(organ, support) : ContentHash{};
  if (store != nullptr) {
    if (std::optional<BodyCompliance> kept = kept_compliance(*store, key, organ, support))
      return *std::move(kept);
  }
  const geometry::HeldSurface held(support, organ);
  geometry::check_support(support, organ);
  BodyCompliance made{finest_pieces(organ, support), {}};
  Body body(made);
  body.add_pieces();
  body.add_support(organ, held);
  if (!body.invert())
    throw InputError("support: holds too little of the organ's surface, so the organ would turn away");
  if (store != nullptr)
    store->store_response(
        key, {made.pieces.cells().whole().edge(), made.compliance.scale(), made.compliance.entries()});
  return made;
}

}  // namespace palpate::deform
