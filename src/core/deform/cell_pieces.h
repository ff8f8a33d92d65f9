#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/index.h"
#include "core/deform/cell_parts.h"
#include "palpate/mesh.h"

namespace palpate::deform {

/// The connected pieces into which cells cut an organ, the splines of each, and the nodes of these.
class CellPieces final {
 public:
  using Splines = std::array<std::int32_t, CellGrid::kNodesOfCell>;
  struct Piece {
    std::size_t cell = 0;
    Splines splines{};  // in the order of CellGrid::weights()
  };
  /// A point's piece, and its position in the piece's cell.
  struct Place {
    std::size_t piece = 0;
    std::array<double, 3> within{};
  };
  /// Part of a spline's coefficient: a node, and its weight.
  using Term = std::pair<std::int32_t, float>;
  /// Integrals of x^a y^b z^c over a piece, from 0 to 1 along each axis of its cell, at [a][b][c].
  using Moments = std::array<std::array<std::array<double, 5>, 5>, 5>;

  /// [setup] @param grid what lies outside it is left out @param organ closed, outwards
  /// @param cut_thin thin cells are cut into eight
  CellPieces(const CellGrid& grid, const geometry::TriangleMesh& organ, bool cut_thin = true);

  [[nodiscard]] const CutCells& cells() const noexcept { return cells_; }
  [[nodiscard]] const std::vector<Piece>& pieces() const noexcept { return pieces_; }
  [[nodiscard]] double edge_of(std::size_t piece) const noexcept {
    return cells_.edge_of(pieces_[piece].cell);
  }
  [[nodiscard]] std::size_t nodes() const noexcept { return planes_.back(); }
  /// [any] The first node of each plane of nodes across the grid's longest axis, and nodes() at the end.
  [[nodiscard]] const std::vector<std::size_t>& planes() const noexcept { return planes_; }
  /// [any] The first splines are the nodes.
  [[nodiscard]] std::size_t splines() const noexcept { return nodes() + first_term_.size() - 1; }
  /// [any] The terms of a spline that is not a node itself, in ascending order of nodes.
  [[nodiscard]] std::span<const Term> terms_of(std::int32_t spline) const noexcept {
    const std::size_t n = at(spline) - nodes();
    return std::span(terms_).subspan(first_term_[n], first_term_[n + 1] - first_term_[n]);
  }
  /// [any] Calls use(node, weight) for every term of a spline.
  template <typename Use>
  void for_each_term(std::int32_t spline, const Use& use) const {
    if (at(spline) < nodes()) {
      use(spline, 1.0F);
      return;
    }
    for (const auto& [node, weight] : terms_of(spline)) use(node, weight);
  }

  /// [any] The piece of a surface point, in its cell or in the nearest one that has a piece.
  /// @param outward unit normal there
  [[nodiscard]] Place place_of(const Vec3& point, const Vec3& outward) const noexcept;
  /// [any] The share of its cell that a piece fills, 0 to 1.
  [[nodiscard]] double share(std::size_t piece) const noexcept;
  [[nodiscard]] Moments moments(std::size_t piece) const noexcept;
  /// [setup] Calls use(within, share) for points of a piece; the shares add up to share().
  template <typename Use>
  void for_each_point(std::size_t piece, const Use& use) const {
    constexpr int kSteps = 6;
    for (const LinePart& part : parts_of(piece)) {
      const double step = (part.to - part.from) / kSteps;
      for (int i = 0; i < kSteps; ++i)
        use(std::array<double, 3>{part.place.x(), part.place.y(), part.from + (i + 0.5) * step},
            step * part.area);
    }
  }

 private:
  // A piece's splines of the grid and of its halves; -1 where that spline is no node, or none of its cell's.
  struct OwnNodes {
    Splines whole, halves;
  };
  void number_nodes(const CellParts::Links& links);
  void add_terms();
  [[nodiscard]] std::span<const LinePart> parts_of(std::size_t piece) const noexcept {
    return std::span(parts_).subspan(first_part_[piece], first_part_[piece + 1] - first_part_[piece]);
  }

  CutCells cells_;
  std::vector<Piece> pieces_;             // by their cell
  std::vector<std::size_t> first_piece_;  // per cell, and one more at the end
  std::vector<LinePart> parts_;           // by piece
  std::vector<std::size_t> first_part_;   // per piece, and one more at the end
  std::vector<OwnNodes> own_;             // per piece; only while it is made
  std::vector<std::size_t> planes_;
  std::vector<Term> terms_;
  std::vector<std::size_t> first_term_;  // per spline from nodes() on, and one more at the end
};

}  // namespace palpate::deform
