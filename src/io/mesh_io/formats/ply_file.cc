#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/ply_vertices.h"
#include "io/mesh_io/formats/surface_builder.h"

namespace palpate::mesh_io {
namespace {

struct Property {
  std::string name;
  NumberType type = NumberType::kFloat;
  std::optional<NumberType> count_type;  // of a list
  std::optional<std::size_t> column;     // of a vertex, in PlyReader::properties_
  [[nodiscard]] bool names_vertices() const {
    return count_type && (name == "vertex_indices" || name == "vertex_index");
  }
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class PlyReader final {
 public:
  explicit PlyReader(const MeshFile& file) : scan_(file) {}

  ImportedMesh run() {
    read_header();
    for (const Element& element : elements_) read_all(element);
    return surface_.take();
  }

  PlyVertices vertices_with(std::span<const std::string_view> wanted) {
    read_header();
    const auto vertex = std::find_if(elements_.begin(), elements_.end(),
                                     [](const Element& element) { return element.name == "vertex"; });
    if (vertex == elements_.end()) scan_.refuse("the header has no element vertex");
    if (vertex->count > kMaxPlyVertices) {
      scan_.refuse(
          fmt::format("{} vertices: at most {} are read with their values", vertex->count, kMaxPlyVertices));
    }
    for (Property& property : vertex->properties) {
      const bool is_wanted = std::find(wanted.begin(), wanted.end(), property.name) != wanted.end();
      const bool is_again = std::any_of(properties_.begin(), properties_.end(),
                                        [&](const PlyProperty& p) { return p.name == property.name; });
      if (!is_wanted || is_again || property.count_type) continue;
      property.column = properties_.size();
      properties_.push_back({property.name, property.type});
    }
    for (auto element = elements_.begin(); element <= vertex; ++element) read_all(*element);
    return {std::move(surface_.vertices), std::move(properties_)};
  }

 private:
  void read_all(const Element& element) {
    check(element);
    for (std::size_t n = 1; n <= element.count; ++n) read(element, n);
  }

  void read_header() {
    if (!scan_.next_line() || scan_.rest_of_line() != "ply") scan_.refuse("must start with \"ply\"");
    std::optional<MeshScan::Encoding> encoding;
    std::string_view word;
    while (word != "end_header") {
      if (!scan_.next_line()) scan_.refuse("truncated: the header does not end");
      word = scan_.word();
      if (word == "format") encoding = encoding_of(scan_.word());
      if (word == "element") add_element();
      if (word == "property") add_property();
    }
    if (!encoding) scan_.refuse("the header has no format");
    scan_.leave_lines();
    scan_.set_encoding(*encoding);
  }

  [[nodiscard]] MeshScan::Encoding encoding_of(std::string_view word) const {
    if (word == "ascii") return MeshScan::Encoding::kText;
    if (word == "binary_little_endian") return MeshScan::Encoding::kLittleEndian;
    if (word == "binary_big_endian") return MeshScan::Encoding::kBigEndian;
    scan_.refuse(fmt::format("format \"{}\": must be ascii, binary_little_endian or binary_big_endian",
                             excerpt(word, 40)));
  }

  void add_element() {
    constexpr std::size_t kMax = 100;
    if (elements_.size() == kMax) {
      scan_.refuse(fmt::format("the header declares more than {} elements", kMax));
    }
    Element element;
    element.name = scan_.word();
    for (const Element& other : elements_) {
      if (other.name == element.name) scan_.refuse("the header declares element " + element.name + " twice");
    }
    element.count = scan_.count(element.name);
    if (element.name == "vertex") vertices_ = element.count;
    elements_.push_back(std::move(element));
  }

  void add_property() {
    if (elements_.empty()) scan_.refuse("a property comes before any element");
    Property property;
    if (scan_.peek() == "list") {
      (void)scan_.word();
      property.count_type = scan_.type();
    }
    property.type = scan_.type();
    property.name = scan_.word();
    if (property.name.empty()) {
      scan_.refuse("a property of element " + elements_.back().name + " has no name");
    }
    std::vector<Property>& properties = elements_.back().properties;
    constexpr std::size_t kMax = 1000;
    if (properties.size() == kMax) {
      scan_.refuse(fmt::format("element {} has more than {} properties", elements_.back().name, kMax));
    }
    properties.push_back(std::move(property));
  }

  void check(const Element& element) {
    if (element.name == "tristrips") {
      scan_.refuse("element tristrips: a surface in strips is not read, must be in element face");
    }
    const std::vector<Property>& all = element.properties;
    if (element.name == "face" &&
        std::none_of(all.begin(), all.end(), [](const Property& p) { return p.names_vertices(); })) {
      scan_.refuse("element face has no list vertex_indices");
    }
    std::size_t least = 0;
    for (const Property& property : all)
      least += scan_.least_bytes(property.count_type.value_or(property.type));
    if (least == 0) scan_.refuse("element " + element.name + " has no properties");
    scan_.require_room(element.count, least, "x " + element.name);
    if (element.name == "vertex") surface_.expect_vertices(element.count);
  }

  void read(const Element& element, std::size_t n) {
    const bool is_vertex = element.name == "vertex";
    Vec3 point = Vec3::Zero();
    scan_.reading(element.name, n, element.count);
    for (const Property& property : element.properties) {
      if (property.count_type) {
        read_list(element, property);
        continue;
      }
      const double value = scan_.real(property.type);
      if (property.column) properties_[*property.column].values.push_back(value);
      const std::size_t axis = std::string_view("xyz").find(property.name);
      if (is_vertex && property.name.size() == 1 && axis < 3) point[static_cast<int>(axis)] = value;
    }
    if (!is_vertex) return;
    scan_.require_finite(point);
    surface_.add_vertex(point);
  }

  void read_list(const Element& element, const Property& property) {
    const std::size_t length = scan_.as_count(scan_.whole(*property.count_type), "numbers of a list");
    if (element.name != "face" || !property.names_vertices())
      return scan_.skip_numbers(length, property.type);
    corners_.clear();
    for (std::size_t k = 0; k < length; ++k) corners_.push_back(scan_.index(property.type, vertices_));
    surface_.add_polygon(corners_);
  }

  MeshScan scan_;
  SurfaceBuilder surface_{scan_};
  std::vector<Element> elements_;
  std::vector<PlyProperty> properties_;  // wanted, of the vertices
  std::vector<std::int32_t> corners_;    // of one face
  std::size_t vertices_ = 0;             // declared
};

}  // namespace

ImportedMesh read_ply(const MeshFile& file) { return PlyReader(file).run(); }

const PlyProperty* PlyVertices::find(std::string_view name) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [name](const PlyProperty& property) { return property.name == name; });
  return found == properties.end() ? nullptr : &*found;
}

PlyVertices read_ply_vertices(const MeshFile& file, std::span<const std::string_view> wanted) {
  return PlyReader(file).vertices_with(wanted);
}

}  // namespace palpate::mesh_io
