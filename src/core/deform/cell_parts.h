#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/disjoint_sets.h"
#include "core/deform/cell_grid.h"
#include "palpate/mesh.h"

namespace palpate::deform {

/// Surface parts are at most this part of a cell long.
inline constexpr double kPartsOfCell = 4.0;
/// Depth below the surface at which the part of a surface point is looked for [cells]. Beyond a narrow gap
/// another part may be nearer to the surface itself.
inline constexpr double kBelow = 0.12;

/// The cells of a grid, some of them cut into eight. Cells are numbered: first those of the grid, then all
/// their eighths.
class CutCells final {
 public:
  struct Place {
    std::size_t cell = 0;
    std::array<double, 3> within{};  // 0 to 1 along each axis
  };
  explicit CutCells(const CellGrid& whole)
      : whole_(whole), eighths_(whole.halved()), cut_(whole.cell_count()) {}

  void cut(std::size_t cell) { cut_[cell] = true; }
  [[nodiscard]] bool is_cut(std::size_t cell) const noexcept { return cut_[cell]; }
  [[nodiscard]] const CellGrid& whole() const noexcept { return whole_; }
  [[nodiscard]] const CellGrid& eighths() const noexcept { return eighths_; }
  [[nodiscard]] std::size_t count() const noexcept { return whole_.cell_count() + eighths_.cell_count(); }
  [[nodiscard]] bool is_eighth(std::size_t cell) const noexcept { return cell >= whole_.cell_count(); }
  [[nodiscard]] std::size_t eighth(const std::array<int, 3>& cell) const noexcept {
    return whole_.cell_count() + eighths_.number_of(cell);
  }
  /// Its place in its own grid.
  [[nodiscard]] std::array<int, 3> cell_of(std::size_t cell) const noexcept {
    return is_eighth(cell) ? eighths_.cell_of(cell - whole_.cell_count()) : whole_.cell_of(cell);
  }
  /// [m]
  [[nodiscard]] double edge_of(std::size_t cell) const noexcept {
    return is_eighth(cell) ? eighths_.edge() : whole_.edge();
  }
  [[nodiscard]] Place place_of(const Vec3& point) const noexcept;
  /// The position of a point in a cell, which may lie outside it.
  [[nodiscard]] std::array<double, 3> within(std::size_t cell, const Vec3& point) const noexcept;

 private:
  CellGrid whole_;
  CellGrid eighths_;
  std::vector<bool> cut_;
};

/// The part of a line along z that lies inside an organ and one cell, 0 to 1 along each axis of the cell.
struct LinePart {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double from = 0.0;
  double to = 0.0;
  double area = 0.0;  // for which it counts, of the cell's face

  [[nodiscard]] double squared_distance(const std::array<double, 3>& point) const noexcept;
};

/// Lines through an organ, cut into parts by its cells, and what is connected.
class CellParts final {
 public:
  struct Part {
    std::size_t cell = 0;
    LinePart line;
  };
  using Links = std::vector<std::array<std::uint32_t, 2>>;

  /// [setup] @param organ closed, outwards @param cut_thin thin cells are cut
  CellParts(CutCells& cells, const geometry::TriangleMesh& organ, bool cut_thin);

  /// [any] By their cell.
  [[nodiscard]] const std::vector<Part>& parts() const noexcept { return parts_; }
  /// [setup] The first part in the same cell that is connected with a part.
  [[nodiscard]] std::uint32_t first_connected(std::uint32_t part) { return in_cell_.find(part); }
  /// [any] Connected parts in different cells.
  [[nodiscard]] const Links& links() const noexcept { return links_; }

 private:
  static constexpr std::size_t kLines = 64;  // through every column of the grid's cells
  // A part of a line inside the organ [cells of the grid].
  struct Segment {
    double from = 0.0;
    double to = 0.0;
    std::size_t first_part = 0;  // in order_
    std::size_t parts = 0;
  };
  [[nodiscard]] std::size_t line_at(int x, int y) const noexcept;
  void cut_lines(const geometry::TriangleMesh& organ);
  void cut_thin_cells();
  [[nodiscard]] geometry::TriangleMesh surface_here(const geometry::TriangleMesh& organ) const;
  void cut_parts();
  void add_reached(const geometry::TriangleMesh& organ);
  void sort();
  void connect(std::uint32_t a, std::uint32_t b);
  void connect_beside(const std::vector<Segment>& a, const std::vector<Segment>& b);
  void connect_lines();
  void connect_along(const geometry::TriangleMesh& organ);

  CutCells& cells_;
  std::array<Eigen::Vector2d, kLines> lines_;   // in each column, 0 to 1
  std::vector<std::vector<Segment>> segments_;  // per line
  std::vector<Part> parts_;
  std::vector<std::uint32_t> order_;  // the segments' parts in parts_
  std::vector<double> tops_;          // of the segments' parts [cells of the grid]
  DisjointSets in_cell_{0};
  Links links_;
};

}  // namespace palpate::deform
