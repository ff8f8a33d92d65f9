// How much softer an organ is held by its attachments than its cells show.
//
// An organ that hangs on a narrow part moves nearly as a rigid body on a soft joint: the part near the
// attachment. Cells as large as the part's thickness, and splines that reach over the clefts beside it, make
// the joint too stiff, and then the organ sways too little. Smaller cells there would need too many nodes,
// but the joint alone needs only few, and its motion against the rest has six numbers:
//
//            held                      all nodes beyond the reach move as one rigid body
//        ____####____
//        |  joint   |  reach           S  rigid motion under the unit force and moment (6 x 6)
//      --+----------+--                U  displacement of all nodes when the rest moves by a unit (n x 6)
//      |   the rest   |                F  forces that move the rest so, K U of the joint alone (n x 6)
//
// 1. Attachments whose reaches meet are one joint. It is held by them alone. Where they hold a thick
//    part, the organ's cells are small enough, and an organ that a bed or faces hold as well does not sway.
// 2. S, U and F follow from the organ's own cells. S' follows from smaller cells, not cut, in a box around
//    the joint, or somewhat larger ones where they would need too many nodes. Of two ways for them to lie,
//    that with more nodes is taken, since it separates more of what lies beside clefts.
// 3. S' = X diag(l) X' and S = X X' share six modes X. Stiffnesses in series add up as compliances, so with
//    the joint of the smaller cells in place of the organ's, the stiffness of the whole organ is
//
//        K' = K - sum over modes of (1 - 1/l) f f'          f = F x
//
//    which is exact for what the six numbers describe, also for several joints. The inverse of K' costs one
//    column more for each mode (block_inverse.h).
// 4. Modes with l below kClear are left out: S also changes by so much with where the cells lie.
//
// Source: static condensation and modes of a component that are fixed at its border (Craig and Bampton 1968).

#include "core/deform/attachment_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/base/disjoint_sets.h"
#include "core/base/index.h"
#include "core/deform/body_stiffness.h"
#include "core/deform/surface_parts.h"

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Motions = Eigen::Matrix<double, 3, 6>;  // of a node, by each of six rigid motions

constexpr double kReach = 2.0;       // of a joint around what is held, in the organ's cells
constexpr double kSmaller = 0.4;     // edge of the joint's cells, of the organ's
constexpr double kJointNodes = 1.6;  // at most, of the organ's
constexpr double kLarger = 1.08;     // by which its cells grow while they need more
constexpr double kLargest = 0.75;    // larger ones would tell little
constexpr double kClear = 1.15;      // least factor by which a mode is softer
constexpr double kThin = 0.25;       // share of held places in cut cells; organs have 0 to 0.01 or 0.47 to 1
constexpr double kThinned = 0.25;    // cells, distance of the held places that are kept

// A rigid motion needs a coefficient of every node: its spline's place, unless other splines over it have
// part of the motion already.
struct Node {
  Vec3 place = Vec3::Zero();
  Eigen::Vector4d coefficient = Eigen::Vector4d::Zero();  // of the motions x, y, z and 1
};

std::vector<Node> nodes_of(const CellPieces& pieces) {
  std::vector<Node> nodes(pieces.nodes());
  std::vector<bool> known(pieces.nodes(), false);
  const CutCells& cells = pieces.cells();
  const auto set_nodes = [&](bool eighths) {
    for (const CellPieces::Piece& piece : pieces.pieces()) {
      if (cells.is_eighth(piece.cell) != eighths) continue;
      const std::array<int, 3> cell = cells.cell_of(piece.cell);
      for (std::size_t s = 0; s < piece.splines.size(); ++s) {
        const std::array<std::size_t, 3> offset = {s / 9, s / 3 % 3, s % 3};
        Vec3 place;  // the middle of the spline
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto k = static_cast<Index>(axis);
          place[k] = cells.whole().low()[k] +
                     cells.edge_of(piece.cell) * (cell[axis] + static_cast<double>(offset[axis]) - 0.5);
        }
        Node own{place, place.homogeneous()};
        std::int32_t open = -1;
        pieces.for_each_term(piece.splines[s], [&](std::int32_t node, float weight) {
          if (known[at(node)])
            own.coefficient -= static_cast<double>(weight) * nodes[at(node)].coefficient;
          else
            open = node;
        });
        if (open < 0) continue;
        nodes[at(open)] = own;
        known[at(open)] = true;
      }
    }
  };
  set_nodes(false);  // wide splines first
  set_nodes(true);
  return nodes;
}

Motions motions_of(const Node& node, const Vec3& middle) {
  const Vec3 arm = node.coefficient.head<3>() - node.coefficient[3] * middle;
  Motions motions;
  motions << node.coefficient[3] * Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
  for (Index axis = 0; axis < 3; ++axis) motions.col(3 + axis) = Vec3::Unit(axis).cross(arm);
  return motions;
}

// What one joint is held by.
struct Held {
  geometry::HeldSurface surface;
  std::vector<Vec3> places;  // of it
  Vec3 middle = Vec3::Zero();
};

// One joint in cells.
class Joint {
 public:
  Joint(const CellPieces& pieces, const Held& held, double reach);

  [[nodiscard]] std::size_t free() const noexcept { return planes_.back(); }
  // @return false when no part of the organ lies beyond the joint, or it is not held
  [[nodiscard]] bool solve(const geometry::TriangleMesh& organ);
  [[nodiscard]] const Matrix6& stiffness() const noexcept { return stiffness_; }
  // Of all nodes, when the rest moves by each of six rigid motions.
  [[nodiscard]] MatrixXd forces(const geometry::TriangleMesh& organ) const;

 private:
  [[nodiscard]] bool is_free(std::int32_t node) const { return number_[at(node)] >= 0; }

  const CellPieces& pieces_;
  const Held& held_;
  std::vector<std::int32_t> number_;  // among the free nodes; below 0 for those of the rest
  std::vector<std::size_t> planes_;   // of free nodes
  MatrixXd motions_;                  // U
  Matrix6 stiffness_ = Matrix6::Zero();
};

Joint::Joint(const CellPieces& pieces, const Held& held, double reach)
    : pieces_(pieces), held_(held), planes_{0}, motions_(3 * static_cast<Index>(pieces.nodes()), 6) {
  const std::vector<Node> nodes = nodes_of(pieces);
  for (std::size_t plane = 0; plane + 1 < pieces.planes().size(); ++plane) {
    planes_.push_back(planes_.back());
    for (std::size_t n = pieces.planes()[plane]; n < pieces.planes()[plane + 1]; ++n) {
      const bool is_near = std::any_of(held.places.begin(), held.places.end(), [&](const Vec3& place) {
        return (place - nodes[n].place).squaredNorm() < reach * reach;
      });
      number_.push_back(is_near ? static_cast<std::int32_t>(planes_.back()++) : -1);
      motions_.middleRows<3>(3 * static_cast<Index>(n)) = motions_of(nodes[n], held.middle);
    }
  }
}

bool Joint::solve(const geometry::TriangleMesh& organ) {
  const auto free_rows = 3 * static_cast<Index>(free());
  if (free_rows == 0) return false;
  const BodyStiffness stiffness(pieces_, organ, held_.surface);
  BlockSum sum(planes_);
  MatrixXd border = MatrixXd::Zero(free_rows, 6);
  for (std::size_t piece = 0; piece < pieces_.pieces().size(); ++piece) {
    const std::vector<std::int32_t> touched = stiffness.nodes_of(piece);
    if (std::none_of(touched.begin(), touched.end(), [this](std::int32_t n) { return is_free(n); })) continue;
    const auto [nodes, matrix] = stiffness.of(piece);
    MatrixXd rigid = MatrixXd::Zero(matrix.rows(), 6);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      if (!is_free(nodes[a]))
        rigid.middleRows<3>(3 * static_cast<Index>(a)) = motions_.middleRows<3>(3 * Index{nodes[a]});
    const MatrixXd forces = matrix * rigid;
    stiffness_ += rigid.transpose() * forces;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      if (!is_free(nodes[a])) continue;
      const auto row = 3 * static_cast<Index>(a);
      border.middleRows<3>(3 * Index{number_[at(nodes[a])]}) += forces.middleRows<3>(row);
      for (std::size_t b = 0; b <= a; ++b)
        if (is_free(nodes[b]))
          sum.add(number_[at(nodes[a])], number_[at(nodes[b])],
                  matrix.block<3, 3>(row, 3 * static_cast<Index>(b)));
    }
  }
  if (!factorize(sum.matrix())) return false;
  std::vector<double> columns(border.data(), border.data() + border.size());
  palpate::deform::solve(sum.matrix(), columns);
  const Eigen::Map<const MatrixXd> moved(columns.data(), free_rows, 6);
  stiffness_ -= border.transpose() * moved;
  for (std::size_t n = 0; n < number_.size(); ++n)
    if (number_[n] >= 0)
      motions_.middleRows<3>(3 * static_cast<Index>(n)) = -moved.middleRows<3>(3 * Index{number_[n]});
  return stiffness_.allFinite() && Eigen::LLT<Matrix6>(stiffness_).info() == Eigen::Success;
}

MatrixXd Joint::forces(const geometry::TriangleMesh& organ) const {
  const BodyStiffness stiffness(pieces_, organ, held_.surface);
  MatrixXd forces = MatrixXd::Zero(motions_.rows(), 6);
  for (std::size_t piece = 0; piece < pieces_.pieces().size(); ++piece) {
    const std::vector<std::int32_t> touched = stiffness.nodes_of(piece);
    const auto free =
        std::count_if(touched.begin(), touched.end(), [this](std::int32_t n) { return is_free(n); });
    if (free == 0 || static_cast<std::size_t>(free) == touched.size()) continue;
    const auto [nodes, matrix] = stiffness.of(piece);
    MatrixXd moved(matrix.rows(), 6);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      moved.middleRows<3>(3 * static_cast<Index>(a)) = motions_.middleRows<3>(3 * Index{nodes[a]});
    const MatrixXd of_piece = matrix * moved;
    for (std::size_t a = 0; a < nodes.size(); ++a)  // those of the free nodes balance each other
      if (!is_free(nodes[a]))
        forces.middleRows<3>(3 * Index{nodes[a]}) += of_piece.middleRows<3>(3 * static_cast<Index>(a));
  }
  return forces;
}

// Attachments that are one joint.
std::vector<geometry::Support> joints_of(const geometry::Support& support, double reach) {
  const std::vector<geometry::Attachment>& all = support.attachments;
  DisjointSets sets(all.size());
  for (std::uint32_t a = 0; a < all.size(); ++a)
    for (std::uint32_t b = 0; b < a; ++b)
      if ((all[a].point - all[b].point).norm() < all[a].radius + all[b].radius + 2.0 * reach)
        sets.unite(a, b);
  std::map<std::uint32_t, geometry::Support> joints;
  for (std::uint32_t a = 0; a < all.size(); ++a) joints[sets.find(a)].attachments.push_back(all[a]);
  std::vector<geometry::Support> result;
  for (auto& [first, joint] : joints) result.push_back(std::move(joint));
  return result;
}

Held held_of(const geometry::Support& joint, const geometry::TriangleMesh& organ, double edge) {
  Held held{geometry::HeldSurface(joint, organ), {}};
  std::map<std::array<int, 3>, Vec3> thinned;
  for_each_part(organ, edge, [&](const Vec3& point, const Vec3& area) {
    if (!held.surface.holds(point, area)) return;
    const Vec3 x = (point / edge).array().floor();
    thinned.try_emplace({static_cast<int>(x.x()), static_cast<int>(x.y()), static_cast<int>(x.z())}, point);
  });
  for (const auto& [cell, place] : thinned) {
    held.places.push_back(place);
    held.middle += place / static_cast<double>(thinned.size());
  }
  return held;
}

// Whether a good part of what holds a joint lies where the organ is so thin that its cells are cut.
bool is_thin(const CutCells& cells, const Held& held) {
  const auto cut = std::count_if(held.places.begin(), held.places.end(), [&cells](const Vec3& place) {
    return cells.is_eighth(cells.place_of(place).cell);
  });
  return static_cast<double>(cut) > kThin * static_cast<double>(held.places.size());
}

// The pieces in smaller cells around a joint that separate most of those that need at most `most` nodes;
// empty when such cells would be hardly smaller.
std::optional<CellPieces> smaller_pieces(const geometry::TriangleMesh& organ, const Held& held, double reach,
                                         double edge, std::size_t most) {
  const geometry::Bounds all = geometry::bounds(organ);
  geometry::Bounds around{held.places.front(), held.places.front()};
  for (const Vec3& place : held.places) around = {around.low.cwiseMin(place), around.high.cwiseMax(place)};
  const auto pieces_of = [&](double small, double moved) {
    const Vec3 margin = Vec3::Constant(reach + 2.0 * small);  // splines reach so far
    const Vec3 more = Vec3::Constant(moved * small);
    return CellPieces(CellGrid({all.low.cwiseMax(around.low - margin) - more,
                                all.high.cwiseMin(around.high + margin) + more},
                               small),
                      organ, false);
  };
  for (double small = kSmaller * edge; small < kLargest * edge; small *= kLarger) {
    CellPieces pieces = pieces_of(small, 0.0);
    const std::size_t nodes = Joint(pieces, held, reach).free();
    if (nodes > most) continue;
    CellPieces others = pieces_of(small, 0.5);
    const std::size_t nodes_of_others = Joint(others, held, reach).free();
    return nodes_of_others > nodes && nodes_of_others <= most ? std::move(others) : std::move(pieces);
  }
  return std::nullopt;
}

}  // namespace

Softening softened_joints(const CellPieces& pieces, const geometry::TriangleMesh& organ,
                          const geometry::Support& support) {
  Softening softening;
  if (support.bed || support.faces) return softening;
  const double edge = pieces.cells().whole().edge();
  const double reach = kReach * edge;
  const auto most = static_cast<std::size_t>(kJointNodes * static_cast<double>(pieces.nodes()));
  for (const geometry::Support& one : joints_of(support, reach)) {
    const Held held = held_of(one, organ, kThinned * edge);
    if (!is_thin(pieces.cells(), held)) continue;
    const std::optional<CellPieces> smaller = smaller_pieces(organ, held, reach, edge, most);
    if (!smaller) continue;
    Joint joint(pieces, held, reach);
    Joint fine(*smaller, held, reach);
    if (!joint.solve(organ) || !fine.solve(organ)) continue;
    const Eigen::LLT<Matrix6> root(joint.stiffness());
    const Matrix6 lower = root.matrixL();
    const Eigen::SelfAdjointEigenSolver<Matrix6> modes(lower.transpose() * fine.stiffness().inverse() *
                                                       lower);
    std::optional<MatrixXd> forces;
    for (Index m = 0; m < 6; ++m) {
      const double softer = modes.eigenvalues()[m];
      if (softer < kClear) continue;
      if (!forces) forces = joint.forces(organ);
      const Eigen::VectorXd force = *forces * root.matrixU().solve(modes.eigenvectors().col(m));
      softening.forces.insert(softening.forces.end(), force.begin(), force.end());
      softening.shares.push_back(1.0 - 1.0 / softer);
    }
  }
  return softening;
}

}  // namespace palpate::deform
