// Which part of every cell an organ fills, and which splines move it.
//
// A neck is thinner than a body's cells, and may lie beside it. So thin cells are cut into eight, with
// splines of half the width, and what is not connected has splines of its own:
//
//        |  neck   |         |         |       o   one node for both where they are connected
//        |####o####|####o####|####o####|       8   two nodes at one place: of the neck and of the body
//        |         8    8    |####     |
//        |####o####|####o####|####o####|
//        |  body   |         |         |
//
// 1. Lines along z go through every column of cells, cut exactly where they cross the surface. Lines of a
//    column are spread evenly, not in rows, so that faces along the axes are not counted in steps. Cells
//    with no cell around that the organ fills wholly are cut into eight. Cells cut the lines into parts.
// 2. Parts are connected when they follow each other on a line, when their lines are neighbours and they lie
//    side by side, or when an edge of the surface leads from one to the other. Connected parts in one cell
//    are a piece of the organ.
// 3. For each node of the grid the pieces under its splines are sorted into those that are connected among
//    them. Each set has one node. Pieces of bodies that are connected nowhere share a node, since nothing
//    else may hold one of them.
// 4. Eighths alone have splines of half the width: a narrow spline whose pieces are all eighths is a node. A
//    wide one whose pieces are all eighths is none, since the narrow ones under it can do the same.
// 5. A wide spline is a sum of narrow ones: 1/4, 3/4, 3/4, 1/4 along an axis. So an eighth's field is one
//    of narrow splines alone, whose coefficients are sums over nodes: its terms.
// 6. Nodes are numbered by planes across the grid's longest axis, so that few of them couple with each other.
//
// Sources: even spreading by powers of the plastic number (Roberts 2018); splines of their own for parts that
// are not connected (virtual nodes: Molino, Bao and Fedkiw 2004); wide and narrow splines together
// (hierarchical B-splines: Forsey and Bartels 1988; Kraft 1997).

#include "core/deform/cell_pieces.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/base/infinity.h"

namespace palpate::deform {
namespace {

using Cell = std::array<int, 3>;
using Links = CellParts::Links;

// Finds the connected sets among the pieces that a spline reaches.
class Reach {
 public:
  // @param links of all pieces
  Reach(std::size_t pieces, const Links& links);

  // Calls use(set) for each set of connected pieces in `reached`.
  template <typename Use>
  void for_each_set(const std::vector<std::uint32_t>& reached, const Use& use);

 private:
  std::vector<std::vector<std::uint32_t>> linked_;  // per piece
  std::vector<std::uint32_t> body_;                 // per piece: any number that its whole body shares
  std::vector<bool> open_;                          // per piece: reached, and in no set yet
};

Reach::Reach(std::size_t pieces, const Links& links) : linked_(pieces), body_(pieces), open_(pieces, false) {
  DisjointSets bodies(pieces);
  for (const auto& [a, b] : links) {
    linked_[a].push_back(b);
    linked_[b].push_back(a);
    bodies.unite(a, b);
  }
  for (std::uint32_t p = 0; p < pieces; ++p) body_[p] = bodies.find(p);
}

template <typename Use>
void Reach::for_each_set(const std::vector<std::uint32_t>& reached, const Use& use) {
  if (std::any_of(reached.begin(), reached.end(),
                  [&](std::uint32_t p) { return body_[p] != body_[reached.front()]; })) {
    use(reached);
    return;
  }
  for (const std::uint32_t piece : reached) open_[piece] = true;
  std::vector<std::uint32_t> set;
  for (const std::uint32_t first : reached) {
    if (!open_[first]) continue;
    set.assign(1, first);
    open_[first] = false;
    for (std::size_t n = 0; n < set.size(); ++n) {
      for (const std::uint32_t next : linked_[set[n]]) {
        if (!open_[next]) continue;
        open_[next] = false;
        set.push_back(next);
      }
    }
    use(set);
  }
}

// Number of the spline at `offset` from a cell among those of the cell.
std::size_t spline_at(const Cell& offset) { return at(9 * offset[0] + 3 * offset[1] + offset[2]); }

Cell halved(const Cell& eighth) { return {eighth[0] / 2, eighth[1] / 2, eighth[2] / 2}; }

Cell between(const Cell& from, const Cell& to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

}  // namespace

CellPieces::CellPieces(const CellGrid& grid, const geometry::TriangleMesh& organ, bool cut_thin)
    : cells_(grid) {
  CellParts parts(cells_, organ, cut_thin);
  std::vector<std::uint32_t> piece_of;
  first_piece_.assign(cells_.count() + 1, 0);
  first_part_ = {0};
  for (std::uint32_t p = 0; p < parts.parts().size(); ++p) {
    const std::uint32_t first = parts.first_connected(p);
    if (first == p) {
      ++first_piece_[parts.parts()[p].cell + 1];
      pieces_.push_back({parts.parts()[p].cell, {}});
      first_part_.push_back(0);
    }
    piece_of.push_back(first == p ? static_cast<std::uint32_t>(pieces_.size() - 1) : piece_of[first]);
    ++first_part_[piece_of[p] + 1];
  }
  std::partial_sum(first_piece_.begin(), first_piece_.end(), first_piece_.begin());
  std::partial_sum(first_part_.begin(), first_part_.end(), first_part_.begin());
  parts_.resize(piece_of.size());
  std::vector<std::size_t> next = first_part_;
  for (std::size_t p = 0; p < piece_of.size(); ++p) parts_[next[piece_of[p]]++] = parts.parts()[p].line;

  Links links = parts.links();
  for (std::array<std::uint32_t, 2>& link : links)
    link = {std::min(piece_of[link[0]], piece_of[link[1]]), std::max(piece_of[link[0]], piece_of[link[1]])};
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  number_nodes(links);
  add_terms();
}

void CellPieces::number_nodes(const Links& links) {
  OwnNodes none;
  none.whole.fill(-1);
  none.halves.fill(-1);
  own_.assign(pieces_.size(), none);
  Reach reach(pieces_.size(), links);
  std::vector<std::uint32_t> reached;
  const auto add_pieces = [&](std::size_t cell) {
    for (std::size_t p = first_piece_[cell]; p < first_piece_[cell + 1]; ++p)
      reached.push_back(static_cast<std::uint32_t>(p));
  };
  const auto is_eighth = [this](std::uint32_t piece) { return cells_.is_eighth(pieces_[piece].cell); };
  // A spline reaches over the cells of its own number and of the two before along each axis.
  const auto cells_under = [&](const CellGrid& grid, const Cell& spline, const auto& use) {
    Cell first{};
    Cell last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(0, spline[axis] - 2);
      last[axis] = std::min(grid.cells()[axis] - 1, spline[axis]);
    }
    for_each_cell(first, last, use);
  };
  const CellGrid& grid = cells_.whole();
  const auto add_wide = [&](const Cell& spline) {
    reached.clear();
    cells_under(grid, spline, [&](const Cell& cell) {
      if (!cells_.is_cut(grid.number_of(cell))) {
        add_pieces(grid.number_of(cell));
        return;
      }
      const Cell low = {2 * cell[0], 2 * cell[1], 2 * cell[2]};
      for_each_cell(low, {low[0] + 1, low[1] + 1, low[2] + 1},
                    [&](const Cell& eighth) { add_pieces(cells_.eighth(eighth)); });
    });
    reach.for_each_set(reached, [&](const std::vector<std::uint32_t>& set) {
      if (std::all_of(set.begin(), set.end(), is_eighth)) return;
      for (const std::uint32_t p : set) {
        const Cell cell = cells_.cell_of(pieces_[p].cell);
        own_[p].whole[spline_at(between(is_eighth(p) ? halved(cell) : cell, spline))] =
            static_cast<std::int32_t>(planes_.back());
      }
      ++planes_.back();
    });
  };
  const auto add_narrow = [&](const Cell& spline) {
    reached.clear();
    std::size_t before = cells_.count();
    cells_under(cells_.eighths(), spline, [&](const Cell& eighth) {
      const std::size_t whole = grid.number_of(halved(eighth));
      if (cells_.is_cut(whole)) {
        add_pieces(cells_.eighth(eighth));
      } else if (whole != before) {
        add_pieces(whole);
        before = whole;
      }
    });
    std::sort(reached.begin(), reached.end());
    reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
    reach.for_each_set(reached, [&](const std::vector<std::uint32_t>& set) {
      if (!std::all_of(set.begin(), set.end(), is_eighth)) return;
      for (const std::uint32_t p : set)
        own_[p].halves[spline_at(between(cells_.cell_of(pieces_[p].cell), spline))] =
            static_cast<std::int32_t>(planes_.back());
      ++planes_.back();
    });
  };
  const auto longest = static_cast<std::size_t>(std::max_element(grid.cells().begin(), grid.cells().end()) -
                                                grid.cells().begin());
  const auto for_plane = [longest](const CellGrid& of, int plane, const auto& use) {
    Cell first{};
    Cell last = {of.cells()[0] + 1, of.cells()[1] + 1, of.cells()[2] + 1};
    first[longest] = last[longest] = plane;
    for_each_cell(first, last, use);
  };
  planes_ = {0};
  for (int plane = 0; plane < grid.cells()[longest] + 2; ++plane) {
    planes_.push_back(planes_.back());
    for_plane(grid, plane, add_wide);
    // The narrow splines of two planes lie under the wide ones of this plane alone or of it and the next.
    for (int half = 2 * plane; half < std::min(2 * plane + 2, cells_.eighths().cells()[longest] + 2); ++half)
      for_plane(cells_.eighths(), half, add_narrow);
  }
}

void CellPieces::add_terms() {
  std::map<std::vector<Term>, std::int32_t> spline_of;
  first_term_ = {0};
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (!cells_.is_eighth(pieces_[p].cell)) {
      pieces_[p].splines = own_[p].whole;
      continue;
    }
    const Cell eighth = cells_.cell_of(pieces_[p].cell);
    for_each_cell({}, {2, 2, 2}, [&](const Cell& offset) {
      std::vector<Term> terms;
      const std::int32_t own = own_[p].halves[spline_at(offset)];
      if (own >= 0) terms.push_back({own, 1.0F});
      // Along each axis two wide splines reach a narrow one: the nearer with 3/4, the other with 1/4.
      Cell near{};
      Cell far{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int number = eighth[axis] + offset[axis];
        near[axis] = (number + 1) / 2 - eighth[axis] / 2;
        far[axis] = number / 2 + (number % 2 == 0 ? 1 : 0) - eighth[axis] / 2;
      }
      for_each_cell({}, {1, 1, 1}, [&](const Cell& which) {
        Cell wide{};
        float weight = 1.0F;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          wide[axis] = which[axis] == 0 ? near[axis] : far[axis];
          weight *= which[axis] == 0 ? 0.75F : 0.25F;
        }
        const std::int32_t node = own_[p].whole[spline_at(wide)];
        if (node >= 0) terms.push_back({node, weight});
      });
      std::sort(terms.begin(), terms.end());
      std::int32_t& spline = pieces_[p].splines[spline_at(offset)];
      if (terms.size() == 1 && terms.front().second == 1.0F) {
        spline = terms.front().first;
        return;
      }
      const auto [known, added] =
          spline_of.try_emplace(terms, static_cast<std::int32_t>(nodes() + spline_of.size()));
      spline = known->second;
      if (!added) return;
      terms_.insert(terms_.end(), terms.begin(), terms.end());
      first_term_.push_back(terms_.size());
    });
  }
  own_ = {};
}

CellPieces::Place CellPieces::place_of(const Vec3& point, const Vec3& outward) const noexcept {
  const CutCells::Place place = cells_.place_of(point);
  const std::size_t first = first_piece_[place.cell];
  const std::size_t end = first_piece_[place.cell + 1];
  if (end == first + 1) return {first, place.within};
  Place nearest{first, place.within};
  std::array<double, 3> below = place.within;
  for (std::size_t axis = 0; axis < 3; ++axis)
    below[axis] -= kBelow * outward[static_cast<Eigen::Index>(axis)];
  double least = kInfinity;
  for (std::size_t piece = first; piece < end; ++piece) {
    for (const LinePart& part : parts_of(piece)) {
      const double distance = part.squared_distance(below);
      if (distance < least) {
        least = distance;
        nearest.piece = piece;
      }
    }
  }
  for (std::size_t piece = 0; first == end && piece < pieces_.size(); ++piece) {
    const std::array<double, 3> within = cells_.within(pieces_[piece].cell, point);
    double distance = 0.0;
    for (const double t : within) distance += (t - std::clamp(t, 0.0, 1.0)) * (t - std::clamp(t, 0.0, 1.0));
    distance *= edge_of(piece) * edge_of(piece);
    if (distance < least) {
      least = distance;
      nearest = {piece, within};
    }
  }
  return nearest;
}

double CellPieces::share(std::size_t piece) const noexcept {
  double share = 0.0;
  for (const LinePart& part : parts_of(piece)) share += part.area * (part.to - part.from);
  return share;
}

CellPieces::Moments CellPieces::moments(std::size_t piece) const noexcept {
  Moments moments{};
  for (const LinePart& part : parts_of(piece)) {
    std::array<double, 5> along{};
    double low = 1.0;
    double high = 1.0;
    for (std::size_t c = 0; c < 5; ++c) {
      low *= part.from;
      high *= part.to;
      along[c] = part.area * (high - low) / static_cast<double>(c + 1);
    }
    double x = 1.0;
    for (std::size_t a = 0; a < 5; ++a, x *= part.place.x()) {
      double xy = x;
      for (std::size_t b = 0; b < 5; ++b, xy *= part.place.y())
        for (std::size_t c = 0; c < 5; ++c) moments[a][b][c] += xy * along[c];
    }
  }
  return moments;
}

}  // namespace palpate::deform
