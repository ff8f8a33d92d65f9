#include "io/mesh_io/vtk_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/repair/repair_holes.h"
#include "io/mesh_io/text_scan.h"
#include "io/mesh_io/vtk_scan.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr std::size_t kMostVtkTriangles = 20'000'000;  // as for other formats

std::string upper(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text;
}

/// Cells as a file lists them: cell n has the corners from starts[n] to starts[n + 1].
struct Cells {
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> starts{0};
  [[nodiscard]] std::size_t count() const { return starts.size() - 1; }
};

// VTK's numbers of flat cells.
enum CellType : std::int64_t {
  kLastLine = 4,
  kTriangle = 5,
  kStrip = 6,
  kPolygon = 7,
  kPixel = 8,
  kQuad = 9
};

class VtkReader final {
 public:
  explicit VtkReader(const MeshFile& file) : scan_(file) {}

  ImportedMesh run() {
    read_head();
    while (read_section()) {
    }
    if (!has_points_) scan_.refuse("has no POINTS");
    add_grid();
    say(strips_, "took 1 triangle strip apart", "took ", " triangle strips apart");
    say(polygons_, "cut 1 polygon into triangles", "cut ", " polygons into triangles");
    say(lines_, "dropped 1 line or point", "dropped ", " lines or points");
    return std::move(imported_);
  }

 private:
  void say(std::size_t count, const std::string& one, const std::string& before, const std::string& after) {
    if (count == 0) return;
    imported_.repairs.push_back(count == 1 ? one : before + std::to_string(count) + after);
  }

  void read_head() {
    constexpr std::string_view kStart = "# vtk DataFile Version ";
    const std::string_view first = scan_.line("its first line");
    if (!first.starts_with(kStart)) {
      scan_.refuse(
          "must start with \"# vtk DataFile Version\" (XML files of VTK are not read: save it as legacy "
          "VTK)");
    }
    const std::optional<double> version = number(trimmed(first.substr(kStart.size())));
    if (!version || !(*version >= 1.0 && *version < 6.0)) {
      scan_.refuse("version \"" + std::string(first.substr(kStart.size()).substr(0, 20)) +
                   "\": must be 1.0 to 5.1");
    }
    has_offsets_ = *version > 5.05;
    (void)scan_.line("its title");
    const std::string encoding = upper(scan_.line("ASCII or BINARY"));
    if (encoding != "ASCII" && encoding != "BINARY") scan_.refuse("must be ASCII or BINARY here");
    if (upper(scan_.word()) != "DATASET") scan_.refuse("must be DATASET here");
    const std::string dataset = upper(scan_.word());
    is_grid_ = dataset == "UNSTRUCTURED_GRID";
    if (!is_grid_ && dataset != "POLYDATA") {
      scan_.refuse("DATASET " + dataset + " is no surface: must be POLYDATA or UNSTRUCTURED_GRID");
    }
    scan_.set_binary(encoding == "BINARY");
  }

  /// @return false at the end of what matters
  bool read_section() {
    const std::string name = upper(scan_.word());
    if (name.empty() || name == "CELL_DATA" || name == "POINT_DATA") return false;
    if (name == "POINTS") {
      read_points();
    } else if (name == "METADATA") {
      scan_.skip_to_empty_line();
    } else if (name == "FIELD") {
      skip_field();
    } else if (!is_grid_ && (name == "VERTICES" || name == "LINES")) {
      lines_ += read_cells(name).count();
    } else if (!is_grid_ && name == "POLYGONS") {
      const Cells cells = read_cells(name);
      for (std::size_t n = 0; n < cells.count(); ++n) add_polygon(cells, n);
    } else if (!is_grid_ && name == "TRIANGLE_STRIPS") {
      const Cells cells = read_cells(name);
      for (std::size_t n = 0; n < cells.count(); ++n) add_strip(cells, n);
    } else if (is_grid_ && name == "CELLS") {
      grid_ = read_cells(name);
    } else if (is_grid_ && name == "CELL_TYPES") {
      read_cell_types();
    } else {
      scan_.refuse("\"" + name + "\" is not a part of such a file");
    }
    return true;
  }

  void read_points() {
    if (has_points_) scan_.refuse("POINTS come twice");
    has_points_ = true;
    const std::size_t count = scan_.count("points");
    const VtkType type = scan_.type("coordinates");
    if (type != VtkType::kFloat && type != VtkType::kDouble) scan_.refuse("POINTS must be float or double");
    scan_.begin_numbers(3 * count, type, "POINTS");
    imported_.mesh.vertices.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
      Vec3 point;
      for (int k = 0; k < 3; ++k) {
        point[k] = scan_.real(type, "POINTS");
        if (!(std::abs(point[k]) <= static_cast<double>(std::numeric_limits<float>::max()))) {
          scan_.refuse(fmt::format("vertex {} is not finite (NaN, infinite or past 3.4e38)", n + 1));
        }
      }
      imported_.mesh.vertices.push_back(point);
    }
  }

  /// FIELD name arrays, and each array: name, components, tuples, type, numbers.
  void skip_field() {
    (void)scan_.word();
    const std::size_t arrays = scan_.count("arrays in FIELD");
    for (std::size_t n = 0; n < arrays; ++n) {
      if (upper(scan_.peek()) == "METADATA") {
        (void)scan_.word();
        scan_.skip_to_empty_line();
      }
      const std::string name = "FIELD " + std::string(scan_.word().substr(0, 40));
      const std::size_t components = scan_.count("components of " + name);
      const std::size_t tuples =
          scan_.count("tuples of " + name);  // both at most the file's size: no overflow
      scan_.skip_numbers(components * tuples, scan_.type(name), name);
    }
  }

  Cells read_cells(const std::string& name) {
    return has_offsets_ ? read_offset_cells(name) : read_counted_cells(name);
  }

  /// n, and how many numbers follow: of each cell its number of corners and the corners.
  Cells read_counted_cells(const std::string& name) {
    const std::size_t count = scan_.count("cells of " + name);
    const std::size_t numbers = scan_.count("numbers of " + name);
    scan_.begin_numbers(numbers, VtkType::kInt32, name);
    if (count > numbers)
      scan_.refuse(fmt::format("{} cells of {} take more than {} numbers", count, name, numbers));
    Cells cells;
    std::size_t left = numbers;
    for (std::size_t n = 0; n < count; ++n) {
      if (left == 0) scan_.refuse(fmt::format("{} has fewer numbers than its {} cells need", name, count));
      const std::int64_t corners = scan_.whole(VtkType::kInt32, name);
      --left;
      if (corners < 0 || static_cast<std::uint64_t>(corners) > left) {
        scan_.refuse(fmt::format("{} has {} corners, must be 0 to {}", cell(name, n), corners, left));
      }
      left -= static_cast<std::size_t>(corners);
      for (std::int64_t k = 0; k < corners; ++k) add_corner(cells, VtkType::kInt32, name);
      cells.starts.push_back(cells.corners.size());
    }
    if (left > 0)
      scan_.refuse(fmt::format("{} declares {} numbers, its cells have {}", name, numbers, numbers - left));
    return cells;
  }

  /// Version 5.1: number of offsets (one more than cells) and of corners, then both lists.
  Cells read_offset_cells(const std::string& name) {
    const std::size_t offsets = scan_.count("offsets of " + name);
    const std::size_t corners = scan_.count("corners of " + name);
    Cells cells;
    if (offsets == 0) return cells;
    if (upper(scan_.word()) != "OFFSETS") scan_.refuse("must be OFFSETS of " + name + " here");
    const VtkType offset_type = whole_type("OFFSETS");
    scan_.begin_numbers(offsets, offset_type, "OFFSETS of " + name);
    for (std::size_t n = 0; n < offsets; ++n) {
      const std::int64_t offset = scan_.whole(offset_type, "OFFSETS of " + name);
      const auto least = static_cast<std::int64_t>(cells.starts.back());
      const bool is_good =
          n == 0 ? offset == 0 : offset >= least && offset <= static_cast<std::int64_t>(corners);
      if (!is_good) {
        scan_.refuse(fmt::format("offset {} of {} is {}, must be {}", n, name, offset,
                                 n == 0 ? "0" : fmt::format("{} to {}", least, corners)));
      }
      if (n > 0) cells.starts.push_back(static_cast<std::size_t>(offset));
    }
    if (cells.starts.back() != corners) {
      scan_.refuse(
          fmt::format("the last offset of {} is {}, must be {}", name, cells.starts.back(), corners));
    }
    if (upper(scan_.word()) != "CONNECTIVITY") scan_.refuse("must be CONNECTIVITY of " + name + " here");
    const VtkType type = whole_type("CONNECTIVITY");
    scan_.begin_numbers(corners, type, "CONNECTIVITY of " + name);
    for (std::size_t k = 0; k < corners; ++k) add_corner(cells, type, name);
    return cells;
  }

  VtkType whole_type(const std::string& of) {
    const VtkType type = scan_.type(of);
    if (type != VtkType::kInt32 && type != VtkType::kInt64) scan_.refuse(of + " must be vtktypeint64 or int");
    return type;
  }

  void add_corner(Cells& cells, VtkType type, const std::string& name) {
    if (!has_points_) scan_.refuse(name + " come before POINTS");
    const std::int64_t index = scan_.whole(type, name);
    if (index < 0 || static_cast<std::uint64_t>(index) >= imported_.mesh.vertices.size()) {
      scan_.refuse(fmt::format("{}: point {} is out of range: the file has {} points, the first is 0", name,
                               index, imported_.mesh.vertices.size()));
    }
    cells.corners.push_back(static_cast<std::int32_t>(index));
  }

  static std::string cell(const std::string& name, std::size_t n) {
    return fmt::format("cell {} of {}", n, name);
  }

  void read_cell_types() {
    const std::size_t count = scan_.count("CELL_TYPES");
    if (count != grid_.count()) {
      scan_.refuse(fmt::format("CELL_TYPES has {} cells, CELLS {}", count, grid_.count()));
    }
    scan_.begin_numbers(count, VtkType::kInt32, "CELL_TYPES");
    cell_types_.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
      const std::int64_t type = scan_.whole(VtkType::kInt32, "CELL_TYPES");
      if (type < 1 || type > kQuad) {
        scan_.refuse(fmt::format("{} is of type {}: must be flat, 1 to 9 (of a solid grid save its surface)",
                                 cell("CELL_TYPES", n), type));
      }
      cell_types_.push_back(type);
    }
  }

  void add_grid() {
    if (cell_types_.size() != grid_.count()) scan_.refuse("has CELLS but no CELL_TYPES");
    for (std::size_t n = 0; n < cell_types_.size(); ++n) {
      const std::int64_t type = cell_types_[n];
      if (type <= kLastLine) {
        ++lines_;
      } else if (type == kStrip) {
        add_strip(grid_, n);
      } else {
        if (type == kPixel && grid_.starts[n + 1] - grid_.starts[n] == 4) {
          std::swap(grid_.corners[grid_.starts[n] + 2], grid_.corners[grid_.starts[n] + 3]);
        }
        add_polygon(grid_, n);
      }
    }
  }

  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    if (imported_.mesh.triangles.size() >= kMostVtkTriangles) {
      scan_.refuse(fmt::format("more than {} triangles", kMostVtkTriangles));
    }
    imported_.mesh.triangles.push_back({a, b, c});
  }

  void add_strip(const Cells& cells, std::size_t n) {
    const std::size_t begin = cells.starts[n];
    const std::size_t end = cells.starts[n + 1];
    if (end < begin + 3) {
      ++lines_;
      return;
    }
    ++strips_;
    for (std::size_t k = begin; k + 2 < end; ++k) {  // every second one is turned over
      const std::size_t odd = (k - begin) % 2;
      add_triangle(cells.corners[k], cells.corners[k + 1 + odd], cells.corners[k + 2 - odd]);
    }
  }

  void add_polygon(const Cells& cells, std::size_t n) {
    const auto begin = cells.corners.begin() + static_cast<std::ptrdiff_t>(cells.starts[n]);
    const auto end = cells.corners.begin() + static_cast<std::ptrdiff_t>(cells.starts[n + 1]);
    const auto corners = static_cast<std::size_t>(end - begin);
    if (corners < 3) {
      ++lines_;
    } else if (corners == 3) {
      add_triangle(begin[0], begin[1], begin[2]);
    } else {
      const std::vector<std::int32_t> loop(begin, end);
      try {
        budget_.take(corners, "polygon " + std::to_string(n));
      } catch (const InputError& error) {
        scan_.refuse(error.what());
      }
      ++polygons_;
      for (const auto& [a, b, c] :
           least_area_patch(imported_.mesh, loop, [](std::int32_t, std::int32_t) { return true; }))
        add_triangle(a, b, c);
    }
  }

  VtkScan scan_;
  ImportedMesh imported_;
  Cells grid_;
  std::vector<std::int64_t> cell_types_;
  std::size_t lines_ = 0;
  std::size_t strips_ = 0;
  std::size_t polygons_ = 0;
  PolygonBudget budget_;
  bool has_points_ = false;
  bool has_offsets_ = false;
  bool is_grid_ = false;
};

}  // namespace

ImportedMesh read_vtk(const MeshFile& file) { return VtkReader(file).run(); }

}  // namespace palpate::geometry
