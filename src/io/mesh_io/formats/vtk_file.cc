#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/surface_builder.h"

namespace palpate::mesh_io {
namespace {

/// The cells of a file: cell n has the corners from starts[n] to starts[n + 1].
struct Cells {
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> starts{0};
  [[nodiscard]] std::size_t count() const { return starts.size() - 1; }
  [[nodiscard]] std::span<const std::int32_t> at(std::size_t n) const {
    return std::span(corners).subspan(starts[n], starts[n + 1] - starts[n]);
  }
};

class VtkReader final {
 public:
  explicit VtkReader(const MeshFile& file) : scan_(file) {}

  ImportedMesh run() {
    read_head();
    while (read_section()) {
    }
    if (!has_points_) scan_.refuse("has no POINTS");
    if (cell_types_.size() != grid_.count()) scan_.refuse("has CELLS but no CELL_TYPES");
    for (std::size_t n = 0; n < cell_types_.size(); ++n) add_cell(*cell_types_[n], grid_, n);
    return surface_.take();
  }

 private:
  std::string_view head_line(std::string_view wanted) {
    if (!scan_.next_line()) scan_.refuse(fmt::format("truncated: ends before {}", wanted));
    return scan_.rest_of_line();
  }

  void read_head() {
    constexpr std::string_view kStart = "# vtk DataFile Version ";
    const std::string_view first = head_line("its first line");
    if (!first.starts_with(kStart)) {
      scan_.refuse(
          "must start with \"# vtk DataFile Version\" (XML files of VTK are not read: save it as legacy "
          "VTK)");
    }
    const std::string_view version = first.substr(kStart.size());
    const std::optional<double> number = parse_number(trimmed(version));
    if (!number || !(*number >= 1.0 && *number < 6.0)) {
      scan_.refuse(fmt::format("version \"{}\": must be 1.0 to 5.1", excerpt(version, 20)));
    }
    has_offsets_ = *number > 5.05;
    (void)head_line("its title");
    const std::string encoding = upper(head_line("ASCII or BINARY"));
    if (encoding != "ASCII" && encoding != "BINARY") scan_.refuse("must be ASCII or BINARY here");
    scan_.leave_lines();
    if (upper(scan_.word()) != "DATASET") scan_.refuse("must be DATASET here");
    const std::string dataset = upper(scan_.word());
    is_grid_ = dataset == "UNSTRUCTURED_GRID";
    if (!is_grid_ && dataset != "POLYDATA") {
      scan_.refuse("DATASET " + dataset + " is no surface: must be POLYDATA or UNSTRUCTURED_GRID");
    }
    if (encoding == "BINARY") scan_.set_encoding(MeshScan::Encoding::kBigEndian);
  }

  /// @return false after the last section that matters
  bool read_section() {
    const std::string name = upper(scan_.word());
    if (name.empty() || name == "CELL_DATA" || name == "POINT_DATA") return false;
    if (name == "POINTS") {
      read_points();
    } else if (name == "METADATA") {
      skip_to_empty_line();
    } else if (name == "FIELD") {
      skip_field();
    } else if (is_grid_ && name == "CELLS") {
      grid_ = read_cells(name);
    } else if (is_grid_ && name == "CELL_TYPES") {
      read_cell_types();
    } else if (const std::int64_t type = type_of(name); !is_grid_ && type > 0) {
      const Cells cells = read_cells(name);
      for (std::size_t n = 0; n < cells.count(); ++n) add_cell(*vtk_kind(type), cells, n);
    } else {
      scan_.refuse("\"" + name + "\" is not a part of such a file");
    }
    return true;
  }

  /// VTK's cell type for a section of POLYDATA; 0: none.
  static std::int64_t type_of(std::string_view section) {
    if (section == "VERTICES") return 2;
    if (section == "LINES") return 4;
    if (section == "TRIANGLE_STRIPS") return 6;
    return section == "POLYGONS" ? 7 : 0;
  }

  void add_cell(const CellKind& kind, const Cells& cells, std::size_t n) {
    const std::span<const std::int32_t> nodes = cells.at(n);
    scan_.reading("cell", n);
    if (kind.nodes != 0 && nodes.size() != kind.nodes) {
      scan_.refuse_item(fmt::format("{} has {} points, must have {}", kind.name, nodes.size(), kind.nodes));
    }
    surface_.add_cell(kind, nodes);
  }

  void read_points() {
    if (has_points_) scan_.refuse("POINTS come twice");
    has_points_ = true;
    const std::size_t count = scan_.count("points");
    const NumberType type = scan_.type();
    if (type != NumberType::kFloat && type != NumberType::kDouble) {
      scan_.refuse("POINTS must be float or double");
    }
    scan_.begin_numbers(3 * count, type, "POINTS");
    surface_.expect_vertices(count);
    for (std::size_t n = 1; n <= count; ++n) surface_.add_vertex(scan_.point(type, n, count));
  }

  /// Skips the rest of this line and all lines up to an empty one.
  void skip_to_empty_line() {
    do {
      scan_.leave_lines();
    } while (!scan_.rest_of_line().empty());
  }

  void skip_metadata() {
    if (upper(scan_.peek()) != "METADATA") return;
    (void)scan_.word();
    skip_to_empty_line();
  }

  void skip_field() {
    (void)scan_.word();
    const std::size_t arrays = scan_.count("arrays in FIELD");
    for (std::size_t n = 0; n < arrays; ++n) {
      skip_metadata();
      const std::string_view name = scan_.word();
      if (name == "NULL_ARRAY") continue;  // VTK writes only this word for an array that does not exist
      section_ = "FIELD " + excerpt(name, 40);
      const std::size_t components = scan_.count("components of " + section_);
      const std::size_t tuples =
          scan_.count("tuples of " + section_);  // both are at most the file's size: no overflow
      skip_array(components * tuples);
    }
  }

  /// Skips the type and the values of an array, as vtkDataWriter writes them.
  void skip_array(std::size_t values) {
    scan_.reading(section_);
    const std::string type = upper(scan_.peek());
    if (type == "STRING" || type == "UTF8_STRING" || type == "VARIANT") {
      (void)scan_.word();
      scan_.leave_lines();
      scan_.require_room(values, 1, "strings of " + section_);
      for (std::size_t n = 0; n < values; ++n) {
        if (scan_.is_binary() && type != "VARIANT") {
          skip_string();
        } else {
          scan_.leave_lines();  // a line for each value, percent-encoded
        }
      }
      return;
    }
    const bool are_bits = type == "BIT";
    if (are_bits) (void)scan_.word();
    const NumberType numbers = are_bits ? NumberType::kUint8 : scan_.type();
    if (scan_.is_binary()) scan_.leave_lines();
    constexpr std::size_t kBits = 8;  // in a byte
    scan_.skip_numbers(are_bits && scan_.is_binary() ? (values + kBits - 1) / kBits : values, numbers);
  }

  /// Skips a string of a binary file: its length and then its bytes. The first two bits of the length say how
  /// many bytes hold it: 11 one, 10 two, 01 four, 00 eight; the most significant byte comes first.
  void skip_string() {
    constexpr std::array<int, 4> kFurtherBytes{7, 3, 1, 0};
    const auto first = static_cast<std::uint64_t>(scan_.whole(NumberType::kUint8));
    std::uint64_t length = first & 0x3fU;
    for (int n = 0; n < kFurtherBytes[first >> 6U]; ++n) {
      length = length << 8U | static_cast<std::uint64_t>(scan_.whole(NumberType::kUint8));
    }
    scan_.require_room(length, 1, "bytes of a string of " + section_);
    scan_.skip_bytes(length);
  }

  Cells read_cells(const std::string& name) {
    return has_offsets_ ? read_offset_cells(name) : read_counted_cells(name);
  }

  /// Reads n and the count of numbers that follow: for each cell its number of corners and the corners.
  Cells read_counted_cells(const std::string& name) {
    const std::size_t count = scan_.count("cells of " + name);
    const std::size_t numbers = scan_.count("numbers of " + name);
    begin_cells(numbers, NumberType::kInt32, name);
    if (count > numbers) {
      scan_.refuse(fmt::format("{} cells of {} take more than {} numbers", count, name, numbers));
    }
    Cells cells;
    std::size_t left = numbers;
    for (std::size_t n = 0; n < count; ++n) {
      if (left == 0) scan_.refuse(fmt::format("{} has fewer numbers than its {} cells need", name, count));
      const std::int64_t corners = scan_.whole(NumberType::kInt32);
      --left;
      if (corners < 0 || static_cast<std::uint64_t>(corners) > left) {
        scan_.refuse(fmt::format("cell {} of {} has {} corners, must be 0 to {}", n, name, corners, left));
      }
      left -= static_cast<std::size_t>(corners);
      add_corners(cells, static_cast<std::size_t>(corners), NumberType::kInt32);
      cells.starts.push_back(cells.corners.size());
    }
    if (left > 0) {
      scan_.refuse(fmt::format("{} declares {} numbers, its cells have {}", name, numbers, numbers - left));
    }
    return cells;
  }

  /// Version 5.1: the number of offsets (cells + 1) and of corners, then both lists.
  Cells read_offset_cells(const std::string& name) {
    const std::size_t offsets = scan_.count("offsets of " + name);
    const std::size_t corners = scan_.count("corners of " + name);
    Cells cells;
    if (offsets == 0) return cells;
    const NumberType offset_type = begin_list("OFFSETS", offsets, name);
    for (std::size_t n = 0; n < offsets; ++n) {
      const std::int64_t offset = scan_.whole(offset_type);
      const auto least = static_cast<std::int64_t>(cells.starts.back());
      const std::int64_t most = n == 0 ? 0 : static_cast<std::int64_t>(corners);
      if (offset < least || offset > most) {
        scan_.refuse(fmt::format("offset {} of {} is {}, must be {}", n, name, offset,
                                 n == 0 ? "0" : fmt::format("{} to {}", least, most)));
      }
      if (n > 0) cells.starts.push_back(static_cast<std::size_t>(offset));
    }
    if (cells.starts.back() != corners) {
      scan_.refuse(
          fmt::format("the last offset of {} is {}, must be {}", name, cells.starts.back(), corners));
    }
    add_corners(cells, corners, begin_list("CONNECTIVITY", corners, name));
    return cells;
  }

  NumberType begin_list(const std::string& list, std::size_t numbers, const std::string& name) {
    skip_metadata();
    if (upper(scan_.word()) != list) scan_.refuse(fmt::format("must be {} of {} here", list, name));
    const NumberType type = scan_.type();
    if (type != NumberType::kInt32 && type != NumberType::kInt64) {
      scan_.refuse(list + " must be vtktypeint64 or int");
    }
    begin_cells(numbers, type, name);
    return type;
  }

  void begin_cells(std::size_t numbers, NumberType type, const std::string& name) {
    if (!has_points_) scan_.refuse(name + " come before POINTS");
    section_ = name;
    scan_.reading(section_);
    scan_.begin_numbers(numbers, type, name);
  }

  void add_corners(Cells& cells, std::size_t count, NumberType type) {
    for (std::size_t k = 0; k < count; ++k)
      cells.corners.push_back(scan_.index(type, surface_.vertices.size()));
  }

  void read_cell_types() {
    const std::size_t count = scan_.count("CELL_TYPES");
    if (count != grid_.count()) {
      scan_.refuse(fmt::format("CELL_TYPES has {} cells, CELLS {}", count, grid_.count()));
    }
    scan_.reading("CELL_TYPES");
    scan_.begin_numbers(count, NumberType::kInt32, "CELL_TYPES");
    cell_types_.clear();
    cell_types_.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
      const std::int64_t type = scan_.whole(NumberType::kInt32);
      const CellKind* kind = vtk_kind(type);
      if (kind == nullptr) {
        scan_.refuse(
            fmt::format("cell {} is of type {}: must be 1 to 14, or quadratic (21 to 29 or 32)", n, type));
      }
      cell_types_.push_back(kind);
    }
  }

  MeshScan scan_;
  SurfaceBuilder surface_{scan_};
  Cells grid_;
  std::vector<const CellKind*> cell_types_;
  std::string section_;  // the current one
  bool has_points_ = false;
  bool has_offsets_ = false;
  bool is_grid_ = false;
};

}  // namespace

ImportedMesh read_vtk(const MeshFile& file) { return VtkReader(file).run(); }

}  // namespace palpate::mesh_io
