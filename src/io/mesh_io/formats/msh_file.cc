#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/surface_builder.h"

namespace palpate::mesh_io {
namespace {

constexpr NumberType kInt = NumberType::kInt32;
constexpr std::size_t kLongestName = 64;  // of a section

/// Reads MSH files: Gmsh reference manual, "MSH file format" and "Legacy formats".
class MshReader final {
 public:
  explicit MshReader(const MeshFile& file) : scan_(file) {}

  ImportedMesh run() {
    read_format();
    bool has_elements = false;
    for (std::string_view section = scan_.word(); !section.empty(); section = scan_.word()) {
      if (!section.starts_with('$')) scan_.refuse("must be a section here, such as $Nodes");
      if (section.size() > kLongestName) {
        scan_.refuse(fmt::format("section \"{}\": its name must have at most {} bytes", excerpt(section, 40),
                                 kLongestName));
      }
      const std::string end = "$End" + std::string(section.substr(1));
      if (section == "$Nodes") {
        if (!vertex_of_.empty()) scan_.refuse("$Nodes come twice");
        const std::size_t place = scan_.offset();
        begin_section();
        if (is_version_4()) {
          read_node_blocks();
        } else {
          read_nodes();
        }
        sort_tags(place);
        scan_.expect(end);
      } else if (section == "$Elements") {
        if (surface_.vertices.empty()) scan_.refuse("$Elements come before $Nodes");
        begin_section();
        if (is_version_4()) {
          read_element_blocks();
        } else {
          read_elements();
        }
        has_elements = true;
        scan_.expect(end);
      } else {
        scan_.skip_past(end);
      }
    }
    if (!has_elements) scan_.refuse("has no $Elements");
    return surface_.take();
  }

 private:
  [[nodiscard]] bool is_version_4() const { return version_ >= 4.0; }
  [[nodiscard]] bool is_version_41() const { return version_ > 4.05; }
  /// Type of counts, and in version 4.1 of tags.
  [[nodiscard]] NumberType tag_type() const { return is_version_41() ? NumberType::kUint64 : kInt; }

  void read_format() {
    scan_.expect("$MeshFormat");
    const std::string_view version = scan_.word();
    version_ = parse_number(version).value_or(0.0);
    const bool is_read = (version_ >= 2.0 && version_ < 2.3) || (version_ >= 4.0 && version_ < 4.2);
    if (!is_read)
      scan_.refuse(fmt::format("version \"{}\": must be 2.0 to 2.2, 4.0 or 4.1", excerpt(version, 20)));
    const std::string_view form = scan_.word();
    if (form != "0" && form != "1") {
      scan_.refuse(fmt::format("file type \"{}\": must be 0 (text) or 1 (binary)", excerpt(form, 20)));
    }
    const std::string_view size = scan_.word();
    if (size != "8") scan_.refuse(fmt::format("data size \"{}\": must be 8", excerpt(size, 20)));
    if (form == "1") find_byte_order();
    scan_.expect("$EndMeshFormat");
  }

  /// The header of a binary file has the number 1 in four bytes.
  void find_byte_order() {
    scan_.set_encoding(MeshScan::Encoding::kLittleEndian);
    scan_.leave_lines();
    scan_.reading("the number 1 that tells the byte order");
    const std::int64_t one = scan_.whole(kInt);
    if (one == 0x01000000) {
      scan_.set_encoding(MeshScan::Encoding::kBigEndian);
    } else if (one != 1) {
      scan_.refuse(fmt::format("the number that tells the byte order is {}, must be 1", one));
    }
  }

  /// In version 2 a binary section begins with a line of text, its count.
  void begin_section() {
    if (is_version_4() && scan_.is_binary()) scan_.leave_lines();
    scan_.reading("$Nodes or $Elements");
  }

  std::size_t count(std::string_view of) { return scan_.as_count(scan_.whole(NumberType::kUint64), of); }

  /// Reads the number of blocks, then `all`, the number of all their entries.
  std::size_t block_count(std::size_t& all, std::string_view of) {
    const std::size_t blocks = count("blocks");
    all = count(of);
    if (is_version_41()) {  // smallest and largest tag
      for (int n = 0; n < 2; ++n) (void)scan_.whole(NumberType::kUint64);
    }
    return blocks;
  }

  /// Number of entries in a block, of the `left` that remain.
  std::size_t count_in_block(std::size_t left, std::string_view of) {
    const std::size_t here = count(of);
    if (here <= left) return here;
    scan_.refuse(fmt::format("a block declares {} {}, of {} that are left", here, of, left));
  }

  void require_all(std::size_t left, std::size_t all, std::string_view of) const {
    if (left > 0) scan_.refuse(fmt::format("declares {} {}, its blocks have {}", all, of, all - left));
  }

  void begin_nodes(std::size_t nodes) {
    scan_.require_room(nodes, scan_.least_bytes(kInt) + 3 * scan_.least_bytes(NumberType::kDouble), "nodes");
    surface_.expect_vertices(nodes);
    vertex_of_.reserve(nodes);
  }

  void read_nodes() {
    const std::size_t nodes = scan_.count("nodes");
    if (scan_.is_binary()) scan_.leave_lines();
    begin_nodes(nodes);
    for (std::size_t n = 1; n <= nodes; ++n) {
      scan_.reading("node", n, nodes);
      add_tag(scan_.whole(kInt));
      surface_.add_vertex(scan_.point(NumberType::kDouble, n, nodes));
    }
  }

  void read_node_blocks() {
    std::size_t nodes = 0;
    const std::size_t blocks = block_count(nodes, "nodes");
    begin_nodes(nodes);
    std::size_t left = nodes;
    for (std::size_t b = 0; b < blocks; ++b) {
      scan_.reading("a block of $Nodes");
      std::int64_t dimension = scan_.whole(kInt);
      const std::int64_t second = scan_.whole(kInt);
      if (!is_version_41()) dimension = second;  // its tag comes first
      const bool is_parametric = scan_.whole(kInt) != 0;
      const std::int64_t parameters = is_parametric ? std::clamp<std::int64_t>(dimension, 0, 3) : 0;
      const std::size_t here = count_in_block(left, "nodes");
      if (is_version_41()) {  // all tags precede all coordinates
        for (std::size_t n = 0; n < here; ++n) add_tag(scan_.whole(tag_type()));
      }
      for (std::size_t n = 0; n < here; ++n) {
        if (!is_version_41()) add_tag(scan_.whole(kInt));
        surface_.add_vertex(scan_.point(NumberType::kDouble, surface_.vertices.size() + 1, nodes));
        for (std::int64_t k = 0; k < parameters; ++k) (void)scan_.real(NumberType::kDouble);
      }
      left -= here;
    }
    require_all(left, nodes, "nodes");
  }

  /// Adds the tag of the next vertex.
  void add_tag(std::int64_t tag) {
    vertex_of_.emplace_back(tag, static_cast<std::int32_t>(vertex_of_.size()));
  }

  /// @param place offset of $Nodes in the file, for the error
  void sort_tags(std::size_t place) {
    std::sort(vertex_of_.begin(), vertex_of_.end());
    const auto twin = std::adjacent_find(vertex_of_.begin(), vertex_of_.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twin != vertex_of_.end()) scan_.refuse_at(place, fmt::format("node {} comes twice", twin->first));
  }

  void read_elements() {
    const std::size_t elements = scan_.count("elements");
    if (scan_.is_binary()) scan_.leave_lines();
    scan_.require_room(elements, 2 * scan_.least_bytes(kInt), "elements");
    for (std::size_t done = 0; done < elements;) {
      scan_.reading("element", done + 1, elements);
      if (!scan_.is_binary()) (void)scan_.whole(kInt);  // its tag
      const CellKind& kind = kind_of(scan_.whole(kInt));
      std::size_t here = 1;
      if (scan_.is_binary()) here = scan_.as_count(std::max<std::int64_t>(1, scan_.whole(kInt)), "elements");
      const std::size_t tags = scan_.as_count(scan_.whole(kInt), "tags");
      if (here > elements - done) {
        scan_.refuse(fmt::format("a block declares {} elements, of {} that are left", here, elements - done));
      }
      for (std::size_t n = 0; n < here; ++n) {
        scan_.reading("element", ++done, elements);
        scan_.skip_numbers((scan_.is_binary() ? 1 : 0) + tags, kInt);
        read_element(kind);
      }
    }
  }

  void read_element_blocks() {
    std::size_t elements = 0;
    const std::size_t blocks = block_count(elements, "elements");
    std::size_t left = elements;
    for (std::size_t b = 0; b < blocks; ++b) {
      scan_.reading("a block of $Elements");
      for (int n = 0; n < 2; ++n) (void)scan_.whole(kInt);  // entity
      const CellKind& kind = kind_of(scan_.whole(kInt));
      const std::size_t here = count_in_block(left, "elements");
      for (std::size_t n = 0; n < here; ++n) {
        scan_.reading("element", elements - left + n + 1, elements);
        (void)scan_.whole(tag_type());
        read_element(kind);
      }
      left -= here;
    }
    require_all(left, elements, "elements");
  }

  [[nodiscard]] const CellKind& kind_of(std::int64_t type) const {
    const CellKind* kind = gmsh_kind(type);
    if (kind != nullptr) return *kind;
    scan_.refuse(
        fmt::format("elements of type {} are not read: must be of first or second order (1 to 19)", type));
  }

  void read_element(const CellKind& kind) {
    nodes_.clear();
    for (std::size_t k = 0; k < kind.nodes; ++k) {
      const std::int64_t tag = scan_.whole(tag_type());
      const auto vertex = std::lower_bound(vertex_of_.begin(), vertex_of_.end(), std::pair{tag, 0});
      if (vertex == vertex_of_.end() || vertex->first != tag)
        scan_.refuse(fmt::format("node {} is not in $Nodes", tag));
      nodes_.push_back(vertex->second);
    }
    surface_.add_cell(kind, nodes_);
  }

  MeshScan scan_;
  SurfaceBuilder surface_{scan_};
  std::vector<std::pair<std::int64_t, std::int32_t>> vertex_of_;  // tag and vertex; sorted after $Nodes
  std::vector<std::int32_t> nodes_;                               // of one element
  double version_ = 0.0;
};

}  // namespace

ImportedMesh read_msh(const MeshFile& file) { return MshReader(file).run(); }

}  // namespace palpate::mesh_io
