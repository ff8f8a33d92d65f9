#include "core/deform/cell_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/index.h"
#include "core/deform/surface_parts.h"

namespace palpate::deform {
namespace {

using Cell = std::array<int, 3>;

constexpr double kNeighbours = 0.19;  // cells, distance of neighbouring lines; a line's nearest is 0.1 away
constexpr double kRounding = 1e-9;    // cells
constexpr double kFilled = 0.999;     // filled share of a cell that counts as whole

// A crossing of the organ's surface by a line.
struct Crossing {
  double height = 0.0;  // [cells] above the grid's low end
  int turns = 0;        // +1: the line enters the organ
};

}  // namespace

CutCells::Place CutCells::place_of(const Vec3& point) const noexcept {
  const CellGrid::Place place = whole_.place_of(point);
  const std::size_t cell = whole_.number_of(place.cell);
  if (!cut_[cell]) return {cell, place.within};
  const CellGrid::Place in_eighth = eighths_.place_of(point);
  return {eighth(in_eighth.cell), in_eighth.within};
}

std::array<double, 3> CutCells::within(std::size_t cell, const Vec3& point) const noexcept {
  const Cell place = cell_of(cell);
  std::array<double, 3> within{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    within[k] = (point[axis] - whole_.low()[axis]) / edge_of(cell) - place[k];
  }
  return within;
}

double LinePart::squared_distance(const std::array<double, 3>& point) const noexcept {
  const double above = point[2] - std::clamp(point[2], from, to);
  return (Eigen::Vector2d(point[0], point[1]) - place).squaredNorm() + above * above;
}

CellParts::CellParts(CutCells& cells, const geometry::TriangleMesh& organ, bool cut_thin) : cells_(cells) {
  // Powers of the plastic number spread points evenly in a square.
  constexpr double kPlastic = 1.32471795724474602596;
  for (std::size_t l = 0; l < kLines; ++l) {
    const double n = static_cast<double>(l) + 0.5;
    lines_[l] = {std::fmod(n / kPlastic, 1.0), std::fmod(n / (kPlastic * kPlastic), 1.0)};
  }
  cut_lines(organ);
  if (cut_thin) cut_thin_cells();
  cut_parts();
  const geometry::TriangleMesh surface = surface_here(organ);
  add_reached(surface);
  sort();
  in_cell_ = DisjointSets(parts_.size());
  connect_lines();
  connect_along(surface);
}

geometry::TriangleMesh CellParts::surface_here(const geometry::TriangleMesh& organ) const {
  const CellGrid& grid = cells_.whole();
  const Vec3 high = grid.low() + grid.edge() * Vec3(grid.cells()[0], grid.cells()[1], grid.cells()[2]);
  geometry::TriangleMesh here{organ.vertices, {}};
  for (const geometry::Triangle& t : organ.triangles) {
    const Vec3& a = organ.vertices[at(t[0])];
    const Vec3& b = organ.vertices[at(t[1])];
    const Vec3& c = organ.vertices[at(t[2])];
    if ((a.cwiseMin(b).cwiseMin(c).array() <= high.array()).all() &&
        (a.cwiseMax(b).cwiseMax(c).array() >= grid.low().array()).all())
      here.triangles.push_back(t);
  }
  return here;
}

std::size_t CellParts::line_at(int x, int y) const noexcept {
  return (static_cast<std::size_t>(x) * static_cast<std::size_t>(cells_.whole().cells()[1]) +
          static_cast<std::size_t>(y)) *
         kLines;
}

void CellParts::cut_lines(const geometry::TriangleMesh& organ) {
  const CellGrid& grid = cells_.whole();
  const double top = grid.cells()[2];  // an organ may be larger than the grid
  std::vector<std::vector<Crossing>> crossings(line_at(grid.cells()[0], 0));
  for (const geometry::Triangle& t : organ.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = (organ.vertices[at(t[k])] - grid.low()) / grid.edge();
    const Eigen::Vector2d ab = (p[1] - p[0]).head<2>();
    const Eigen::Vector2d ac = (p[2] - p[0]).head<2>();
    const double area = ab.x() * ac.y() - ac.x() * ab.y();
    if (area == 0.0) continue;
    const auto span = [&p](Eigen::Index axis) { return std::minmax({p[0][axis], p[1][axis], p[2][axis]}); };
    const auto [low_x, high_x] = span(0);
    const auto [low_y, high_y] = span(1);
    const int last_x = std::min(grid.cells()[0] - 1, static_cast<int>(high_x));
    const int last_y = std::min(grid.cells()[1] - 1, static_cast<int>(high_y));
    for (int x = std::max(0, static_cast<int>(low_x)); x <= last_x; ++x) {
      for (int y = std::max(0, static_cast<int>(low_y)); y <= last_y; ++y) {
        for (std::size_t l = 0; l < kLines; ++l) {
          const Eigen::Vector2d line = Eigen::Vector2d(x, y) + lines_[l];
          if (line.x() < low_x - kRounding || line.x() > high_x + kRounding || line.y() < low_y - kRounding ||
              line.y() > high_y + kRounding)
            continue;
          const Eigen::Vector2d q = line - p[0].head<2>();
          const double u = (q.x() * ac.y() - ac.x() * q.y()) / area;
          const double v = (ab.x() * q.y() - q.x() * ab.y()) / area;
          if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
          const double height = p[0].z() + u * (p[1].z() - p[0].z()) + v * (p[2].z() - p[0].z());
          crossings[line_at(x, y) + l].push_back({std::clamp(height, 0.0, top), area < 0.0 ? 1 : -1});
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
      if (turns != 0 && all[c].height < all[c + 1].height)
        segments_[l].push_back({all[c].height, all[c + 1].height});
    }
  }
}

void CellParts::cut_thin_cells() {
  const CellGrid& grid = cells_.whole();
  std::vector<double> filled(grid.cell_count(), 0.0);
  Cell cell{};
  const Cell end = {grid.cells()[0] - 1, grid.cells()[1] - 1, grid.cells()[2] - 1};
  for (cell[0] = 0; cell[0] <= end[0]; ++cell[0])
    for (cell[1] = 0; cell[1] <= end[1]; ++cell[1])
      for (std::size_t l = 0; l < kLines; ++l)
        for (const Segment& s : segments_[line_at(cell[0], cell[1]) + l])
          for (cell[2] = static_cast<int>(s.from); cell[2] < s.to; ++cell[2])
            filled[grid.number_of(cell)] +=
                (std::min(s.to, cell[2] + 1.0) - std::max(s.from, static_cast<double>(cell[2]))) / kLines;
  for_each_cell({}, end, [&](const Cell& middle) {
    double fullest = 0.0;
    Cell first{};
    Cell last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(0, middle[axis] - 1);
      last[axis] = std::min(end[axis], middle[axis] + 1);
    }
    for_each_cell(first, last,
                  [&](const Cell& c) { fullest = std::max(fullest, filled[grid.number_of(c)]); });
    if (fullest < kFilled) cells_.cut(grid.number_of(middle));
  });
}

void CellParts::cut_parts() {
  const CellGrid& grid = cells_.whole();
  Cell cell{};
  const auto quarter_of = [](const Eigen::Vector2d& line) {
    return (line.x() < 0.5 ? 0U : 2U) + (line.y() < 0.5 ? 0U : 1U);
  };
  std::array<double, 4> in_quarter{};  // lines of a column
  for (const Eigen::Vector2d& line : lines_) ++in_quarter[quarter_of(line)];
  for (cell[0] = 0; cell[0] < grid.cells()[0]; ++cell[0]) {
    for (cell[1] = 0; cell[1] < grid.cells()[1]; ++cell[1]) {
      for (std::size_t l = 0; l < kLines; ++l) {
        for (Segment& segment : segments_[line_at(cell[0], cell[1]) + l]) {
          segment.first_part = parts_.size();
          for (cell[2] = static_cast<int>(segment.from); cell[2] < segment.to; ++cell[2]) {
            const double low = std::max(0.0, segment.from - cell[2]);
            const double high = std::min(1.0, segment.to - cell[2]);
            const std::size_t number = grid.number_of(cell);
            if (!cells_.is_cut(number)) {
              parts_.push_back({number, {lines_[l], low, high, 1.0 / static_cast<double>(kLines)}});
              tops_.push_back(cell[2] + high);
              continue;
            }
            const Eigen::Vector2d place = 2.0 * lines_[l];
            const Eigen::Vector2d half(std::floor(place.x()), std::floor(place.y()));
            for (int upper = 0; upper < 2; ++upper) {
              const double from = std::clamp(2.0 * low - upper, 0.0, 1.0);
              const double to = std::clamp(2.0 * high - upper, 0.0, 1.0);
              if (!(from < to)) continue;
              parts_.push_back(
                  {cells_.eighth({2 * cell[0] + static_cast<int>(half.x()),
                                  2 * cell[1] + static_cast<int>(half.y()), 2 * cell[2] + upper}),
                   {place - half, from, to, 1.0 / in_quarter[quarter_of(lines_[l])]}});
              tops_.push_back(cell[2] + 0.5 * (upper + to));
            }
          }
          segment.parts = parts_.size() - segment.first_part;
        }
      }
    }
  }
}

void CellParts::add_reached(const geometry::TriangleMesh& organ) {
  // Cells that only the surface reaches have an empty part.
  std::vector<bool> has_part(cells_.count(), false);
  for (const Part& part : parts_) has_part[part.cell] = true;
  const auto reach = [&](const Vec3& point) {
    const CutCells::Place place = cells_.place_of(point);
    if (has_part[place.cell]) return;
    has_part[place.cell] = true;
    const auto& [x, y, z] = place.within;
    parts_.push_back({place.cell, {{x, y}, z, z, 0.0}});
  };
  for_each_part(organ, cells_.eighths().edge() / kPartsOfCell,
                [&](const Vec3& point, const Vec3&) { reach(point); });
  for (const geometry::Triangle& t : organ.triangles)
    for (const std::int32_t vertex : t) reach(organ.vertices[at(vertex)]);
}

void CellParts::sort() {
  std::vector<std::uint32_t> by_cell(parts_.size());
  std::iota(by_cell.begin(), by_cell.end(), 0U);
  std::stable_sort(by_cell.begin(), by_cell.end(),
                   [this](std::uint32_t a, std::uint32_t b) { return parts_[a].cell < parts_[b].cell; });
  std::vector<Part> sorted;
  order_.resize(parts_.size());
  for (const std::uint32_t part : by_cell) {
    order_[part] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(parts_[part]);
  }
  parts_ = std::move(sorted);
}

void CellParts::connect(std::uint32_t a, std::uint32_t b) {
  if (parts_[a].cell == parts_[b].cell)
    in_cell_.unite(a, b);
  else
    links_.push_back({a, b});
}

void CellParts::connect_beside(const std::vector<Segment>& a, const std::vector<Segment>& b) {
  for (const Segment& one : a) {
    for (const Segment& other : b) {
      if (!(std::max(one.from, other.from) < std::min(one.to, other.to))) continue;
      std::size_t p = one.first_part;
      std::size_t q = other.first_part;
      double from_p = one.from;
      double from_q = other.from;
      while (p < one.first_part + one.parts && q < other.first_part + other.parts) {
        if (std::max(from_p, from_q) < std::min(tops_[p], tops_[q])) connect(order_[p], order_[q]);
        if (tops_[p] < tops_[q])
          from_p = tops_[p++];
        else
          from_q = tops_[q++];
      }
    }
  }
}

void CellParts::connect_lines() {
  struct Neighbour {
    std::array<int, 2> column;  // of the second, relative to the first's
    std::size_t first, second;
  };
  std::vector<Neighbour> neighbours;
  for (const std::array<int, 2>& column : {std::array{0, 0}, std::array{1, 0}, std::array{0, 1}}) {
    const bool same = column == std::array{0, 0};
    for (std::size_t a = 0; a < kLines; ++a)
      for (std::size_t b = same ? a + 1 : 0; b < kLines; ++b)
        if ((lines_[b] + Eigen::Vector2d(column[0], column[1]) - lines_[a]).norm() < kNeighbours)
          neighbours.push_back({column, a, b});
  }
  for (const std::vector<Segment>& line : segments_)
    for (const Segment& segment : line)
      for (std::size_t part = 1; part < segment.parts; ++part)
        connect(order_[segment.first_part + part - 1], order_[segment.first_part + part]);
  const std::array<int, 3>& columns = cells_.whole().cells();
  for (int x = 0; x < columns[0]; ++x)
    for (int y = 0; y < columns[1]; ++y)
      for (const Neighbour& n : neighbours)
        if (x + n.column[0] < columns[0] && y + n.column[1] < columns[1])
          connect_beside(segments_[line_at(x, y) + n.first],
                         segments_[line_at(x + n.column[0], y + n.column[1]) + n.second]);
}

void CellParts::connect_along(const geometry::TriangleMesh& organ) {
  std::vector<std::uint32_t> first(cells_.count() + 1, 0);
  for (const Part& part : parts_) ++first[part.cell + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<bool> whole(cells_.count(), true);  // all parts of the cell are connected
  for (std::uint32_t p = 0; p < parts_.size(); ++p)
    if (in_cell_.find(p) != in_cell_.find(first[parts_[p].cell])) whole[parts_[p].cell] = false;
  const auto nearest = [&](const Vec3& point, const Vec3& normal) -> std::int64_t {
    CutCells::Place place = cells_.place_of(point);
    if (first[place.cell] == first[place.cell + 1]) return -1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      place.within[axis] -= kBelow * normal[static_cast<Eigen::Index>(axis)];
    std::uint32_t best = first[place.cell];
    for (std::uint32_t p = best + 1; !whole[place.cell] && p < first[place.cell + 1]; ++p)
      if (parts_[p].line.squared_distance(place.within) < parts_[best].line.squared_distance(place.within))
        best = p;
    return best;
  };
  for (const geometry::Triangle& t : organ.triangles) {
    const Vec3 normal = (organ.vertices[at(t[1])] - organ.vertices[at(t[0])])
                            .cross(organ.vertices[at(t[2])] - organ.vertices[at(t[0])])
                            .normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] > t[(k + 1) % 3]) continue;  // the other triangle's
      const Vec3& a = organ.vertices[at(t[k])];
      const Vec3 ab = organ.vertices[at(t[(k + 1) % 3])] - a;
      const double steps = std::ceil(ab.norm() * kPartsOfCell / cells_.eighths().edge());
      std::int64_t before = nearest(a, normal);
      for (double step = 1.0; step <= steps; ++step) {
        const std::int64_t here = nearest(a + step / steps * ab, normal);
        if (here < 0 || here == before) continue;
        if (before >= 0) connect(static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(here));
        before = here;
      }
    }
  }
}

}  // namespace palpate::deform
