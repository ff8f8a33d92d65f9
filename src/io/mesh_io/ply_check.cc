#include "io/mesh_io/ply_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/text_scan.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

enum class Encoding { kText, kLittleEndian, kBigEndian };
enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat32;
  std::optional<Scalar> count_type;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

constexpr std::array<std::pair<std::string_view, Scalar>, 16> kScalars{{{"char", Scalar::kInt8},
                                                                        {"int8", Scalar::kInt8},
                                                                        {"uchar", Scalar::kUint8},
                                                                        {"uint8", Scalar::kUint8},
                                                                        {"short", Scalar::kInt16},
                                                                        {"int16", Scalar::kInt16},
                                                                        {"ushort", Scalar::kUint16},
                                                                        {"uint16", Scalar::kUint16},
                                                                        {"int", Scalar::kInt32},
                                                                        {"int32", Scalar::kInt32},
                                                                        {"uint", Scalar::kUint32},
                                                                        {"uint32", Scalar::kUint32},
                                                                        {"float", Scalar::kFloat32},
                                                                        {"float32", Scalar::kFloat32},
                                                                        {"double", Scalar::kFloat64},
                                                                        {"float64", Scalar::kFloat64}}};

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kInt32:
    case Scalar::kUint32:
    case Scalar::kFloat32:
      return 4;
    case Scalar::kFloat64:
      return 8;
  }
  return 1;
}

template <typename T>
double decoded(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

class PlyCheck final {
 public:
  explicit PlyCheck(const MeshFile& file) : file_(file), lines_(file.bytes) {}

  FileFacts run() {
    read_header();
    for (const Element& element : elements_) {
      check_face(element);
      check_count(element);
      for (std::size_t n = 0; n < element.count; ++n) check_one(element, n);
    }
    FileFacts facts = points_.facts();
    facts.cleaned = text_.take();
    return facts;
  }

 private:
  [[noreturn]] void refuse(const std::string& words) const {
    throw InputError(file_.path.string() + ": " + without_controls(words));
  }

  Scalar scalar_of(std::string_view word) const {
    for (const auto& [name, type] : kScalars) {
      if (name == word) return type;
    }
    refuse(fmt::format("line {}: \"{}\" is not a PLY type", lines_.number(), word));
  }

  void read_header() {
    if (!lines_.next() || trimmed(lines_.line()) != "ply") refuse("must start with \"ply\"");
    std::optional<Encoding> encoding;
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view word = next_word(rest);
      if (word == "end_header") {
        if (!encoding) refuse("the header has no format");
        encoding_ = *encoding;
        body_ = lines_.rest();
        return;
      }
      if (word == "format") encoding = encoding_of(next_word(rest));
      if (word == "element") add_element(rest);
      if (word == "property") add_property(rest);
    }
    refuse("truncated: the header does not end");
  }

  Encoding encoding_of(std::string_view word) const {
    if (word == "ascii") return Encoding::kText;
    if (word == "binary_little_endian") return Encoding::kLittleEndian;
    if (word == "binary_big_endian") return Encoding::kBigEndian;
    refuse("format \"" + std::string(word) + "\": must be ascii, binary_little_endian or binary_big_endian");
  }

  void add_element(std::string_view rest) {
    Element element;
    element.name = next_word(rest);
    for (const Element& other : elements_) {  // of which the importer spoils its memory
      if (other.name == element.name) refuse("the header declares element " + element.name + " twice");
    }
    const std::string_view word = next_word(rest);
    const std::optional<std::int64_t> count = whole_number(word);
    if (!count || *count < 0) refuse(fmt::format("\"{}\" is not a number of {}", word, element.name));
    element.count = static_cast<std::size_t>(*count);
    if (element.name == "vertex") points_.count = element.count;
    elements_.push_back(std::move(element));
  }

  void add_property(std::string_view rest) {
    if (elements_.empty()) refuse("a property comes before any element");
    Property property;
    std::string_view word = next_word(rest);
    if (word == "list") {
      property.count_type = scalar_of(next_word(rest));
      word = next_word(rest);
    }
    property.type = scalar_of(word);
    property.name = next_word(rest);
    if (property.name.empty()) refuse("a property of element " + elements_.back().name + " has no name");
    elements_.back().properties.push_back(std::move(property));
  }

  /// The importer takes any other list for the vertices of a face, and does not look at its numbers.
  void check_face(const Element& element) const {
    const bool has_vertices =
        std::any_of(element.properties.begin(), element.properties.end(), [](const Property& p) {
          return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
        });
    if (element.name == "face" && !has_vertices) refuse("element face has no list vertex_indices");
  }

  void check_count(const Element& element) const {
    std::size_t least = 0;  // bytes of one: two a number in text, the last needs no blank
    for (const Property& property : element.properties) {
      const Scalar first = property.count_type.value_or(property.type);
      least += encoding_ == Encoding::kText ? 2 : size_of(first);
    }
    if (least == 0) refuse("element " + element.name + " has no properties");
    if (element.count > (body_.size() + 1) / least) {
      refuse(fmt::format("truncated: declares {} x {}, but only {} bytes are left", element.count,
                         element.name, body_.size()));
    }
  }

  double take(Scalar type, const Element& element, std::size_t n) {
    if (encoding_ == Encoding::kText) {
      const std::string_view word = next_word(body_);
      if (word.empty()) refuse_as_truncated(element, n);
      const std::optional<double> value = number(word);
      if (!value) {
        refuse(fmt::format("{} {}: \"{}\" is not a number", element.name, n + 1, word.substr(0, 40)));
      }
      return *value;
    }
    const std::size_t size = size_of(type);
    if (body_.size() < size) refuse_as_truncated(element, n);
    std::array<char, 8> bytes{};
    std::copy_n(body_.begin(), size, bytes.begin());
    if (encoding_ == Encoding::kBigEndian)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    body_.remove_prefix(size);
    switch (type) {
      case Scalar::kInt8:
        return decoded<std::int8_t>(bytes.data());
      case Scalar::kUint8:
        return decoded<std::uint8_t>(bytes.data());
      case Scalar::kInt16:
        return decoded<std::int16_t>(bytes.data());
      case Scalar::kUint16:
        return decoded<std::uint16_t>(bytes.data());
      case Scalar::kInt32:
        return decoded<std::int32_t>(bytes.data());
      case Scalar::kUint32:
        return decoded<std::uint32_t>(bytes.data());
      case Scalar::kFloat32:
        return decoded<float>(bytes.data());
      case Scalar::kFloat64:
        return decoded<double>(bytes.data());
    }
    return 0.0;
  }

  [[noreturn]] void refuse_as_truncated(const Element& element, std::size_t n) const {
    refuse(fmt::format("truncated: ends in {} {} of {}", element.name, n + 1, element.count));
  }

  void check_one(const Element& element, std::size_t n) {
    const bool is_vertex = element.name == "vertex";
    Point point{};
    for (const Property& property : element.properties) {
      if (property.count_type) {
        check_list(element, property, n);
        continue;
      }
      const double value = take(property.type, element, n);
      for (std::size_t k = 0; k < 3; ++k) {
        if (is_vertex && property.name == std::string_view("xyz").substr(k, 1))
          point[k] = static_cast<float>(value);
      }
    }
    if (!is_vertex) return;
    require_finite(point, file_.path.string(), n + 1);
    points_.add(point);
    text_.add_point(point);
  }

  void check_list(const Element& element, const Property& property, std::size_t n) {
    const double length = take(*property.count_type, element, n);
    if (!(length >= 0.0 && length <= static_cast<double>(body_.size())) || length != std::floor(length)) {
      refuse_as_truncated(element, n);
    }
    const bool names_vertices = property.name == "vertex_indices" || property.name == "vertex_index";
    if (names_vertices) {
      polygons_.take(static_cast<std::size_t>(length),
                     fmt::format("{}: {} {}", file_.path.string(), element.name, n + 1));
    }
    for (auto left = static_cast<std::size_t>(length); left > 0; --left) {
      const double index = take(property.type, element, n);
      if (!names_vertices) continue;
      if (!(index >= 0.0 && index < static_cast<double>(points_.count)) || index != std::floor(index)) {
        refuse(fmt::format("{} {}: a vertex index is out of range: the file has {} vertices, the first is 0",
                           element.name, n + 1, points_.count));
      }
      if (element.name == "face") text_.add_corner(static_cast<std::uint64_t>(index));
    }
    text_.end_face();
  }

  const MeshFile& file_;
  LineReader lines_;
  Encoding encoding_ = Encoding::kText;
  std::string_view body_;
  std::vector<Element> elements_;
  PointSet points_;
  ObjText text_;
  PolygonBudget polygons_;
};

}  // namespace

FileFacts check_ply(const MeshFile& file) { return PlyCheck(file).run(); }

}  // namespace palpate::geometry
