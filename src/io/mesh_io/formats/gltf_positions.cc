// Positions of vertices that a glTF file has as whole numbers (KHR_mesh_quantization), for importers that
// read floats only.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/mesh_io/formats/gltf_check.h"
#include "io/mesh_io/formats/scan.h"
#include "io/system/base64.h"
#include "io/system/input_file.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxQuantized = 5'000'000;  // vertices of a file
constexpr std::uint64_t kFloatType = 5126;          // glTF's number
constexpr std::string_view kDataStart = "data:application/octet-stream;base64,";

/// The float of a whole number: normalized, the largest is 1 and the least of a signed type -1.
template <typename T>
float dequantized(const char* bytes, bool normalized) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  const auto whole = static_cast<double>(value);
  if (!normalized) return static_cast<float>(whole);
  return static_cast<float>(std::max(-1.0, whole / std::numeric_limits<T>::max()));
}

struct IntegerFormat {
  std::uint64_t gltf;  // glTF's number of the type
  std::size_t bytes;
  float (*as_float)(const char* bytes, bool normalized);
};

constexpr std::array<IntegerFormat, 4> kComponents = {{{5120, 1, dequantized<std::int8_t>},
                                                       {5121, 1, dequantized<std::uint8_t>},
                                                       {5122, 2, dequantized<std::int16_t>},
                                                       {5123, 2, dequantized<std::uint16_t>}}};

class FloatPositions final {
 public:
  explicit FloatPositions(const MeshFile& file) : file_(file), json_(gltf_json_text(file)) {
    root_ = parse_json(json_);
  }

  MeshFile run() {
    const std::size_t first_view = list("bufferViews").size();
    for (json& mesh : list("meshes")) {
      if (!mesh.is_object()) continue;
      for (json& part : list_in(mesh, "primitives")) convert_part(part);
    }
    list("bufferViews").push_back({{"buffer", list("buffers").size()}, {"byteLength", floats_.size()}});
    for (const auto& [accessor, offset] : offsets_) {
      json& converted = list("accessors")[accessor];
      const json count = converted["count"];
      converted = {{"bufferView", first_view},
                   {"byteOffset", offset},
                   {"componentType", kFloatType},
                   {"type", "VEC3"},
                   {"count", count}};
    }
    list("buffers").push_back(
        {{"byteLength", floats_.size()}, {"uri", std::string(kDataStart) + base64(floats_)}});
    return {file_.path, file_.format, packed(root_.dump(-1, ' ', false, json::error_handler_t::replace))};
  }

 private:
  [[noreturn]] void refuse(std::size_t accessor, const std::string& message) const {
    throw InputError(
        fmt::format("{}: accessor {} of quantized positions: {}", to_text(file_.path), accessor, message));
  }

  static json& list_in(json& owner, const char* name) {
    json& found = owner[name];
    if (!found.is_array()) found = json::array();
    return found;
  }
  json& list(const char* name) { return list_in(root_, name); }

  /// A whole number of an object; `otherwise` when it is missing.
  [[nodiscard]] std::uint64_t whole(const json& owner, const char* name, std::uint64_t otherwise,
                                    std::size_t accessor) const {
    const auto found = owner.find(name);
    if (found == owner.end()) return otherwise;
    if (found->is_number_unsigned()) return found->get<std::uint64_t>();
    refuse(accessor, std::string(name) + " must be a whole number");
  }

  /// Converts a part's positions, and leaves it no other attribute and no morph target: quantized ones would
  /// be misread.
  void convert_part(json& part) {
    if (!part.is_object() || !part.contains("attributes") || !part["attributes"].is_object()) return;
    json& attributes = part["attributes"];
    const json position = attributes.value("POSITION", json());
    attributes = json::object();
    part.erase("targets");
    if (position.is_null()) return;
    attributes["POSITION"] = position;
    const json& accessors = list("accessors");
    if (!position.is_number_unsigned() || position.get<std::uint64_t>() >= accessors.size()) return;
    const auto index = position.get<std::size_t>();
    if (offsets_.contains(index) || !accessors[index].is_object()) return;
    if (accessors[index].value("componentType", json(kFloatType)) != kFloatType)
      convert(index, accessors[index]);
  }

  void convert(std::size_t index, const json& accessor) {
    const std::uint64_t type = whole(accessor, "componentType", 0, index);
    const auto* const component =
        std::find_if(kComponents.begin(), kComponents.end(),
                     [&](const IntegerFormat& known) { return known.gltf == type; });
    if (component == kComponents.end()) {
      refuse(index, fmt::format("componentType {}: must be 5120, 5121, 5122, 5123 or 5126", type));
    }
    if (accessor.value("type", json()) != "VEC3") refuse(index, "its type must be VEC3");
    if (accessor.contains("sparse")) refuse(index, "has sparse values, which are not read here");
    const json& views = list("bufferViews");
    const std::uint64_t view_index = whole(accessor, "bufferView", views.size(), index);
    if (view_index >= views.size() || !views[view_index].is_object()) {
      refuse(index, "has no bufferView of this file");
    }
    const json& view = views[view_index];
    const std::uint64_t size = 3 * component->bytes;
    const std::uint64_t stride = whole(view, "byteStride", size, index);
    const std::uint64_t count = whole(accessor, "count", 0, index);
    if (count == 0 || count > kMaxQuantized - vertices_) {
      refuse(index, fmt::format("count {}: must be 1 to {} in all", count, kMaxQuantized));
    }
    vertices_ += count;
    const std::string_view bytes = view_bytes(view, index);
    const std::uint64_t begin = whole(accessor, "byteOffset", 0, index);
    const bool fits = stride >= size && stride <= 252 && begin <= bytes.size() &&
                      (count - 1) * stride + size <= bytes.size() - begin;
    if (!fits) refuse(index, fmt::format("{} vertices do not fit in its {} bytes", count, bytes.size()));
    const bool normalized = accessor.value("normalized", json(false)) == true;
    offsets_[index] = floats_.size();
    for (std::uint64_t n = 0; n < count; ++n) {
      for (std::uint64_t k = 0; k < 3; ++k) {
        const char* const at = bytes.data() + begin + n * stride + k * component->bytes;
        const float x = component->as_float(at, normalized);
        floats_.append(reinterpret_cast<const char*>(&x), sizeof x);
      }
    }
  }

  std::string_view view_bytes(const json& view, std::size_t accessor) {
    const std::uint64_t buffer = whole(view, "buffer", list("buffers").size(), accessor);
    if (buffer >= list("buffers").size()) refuse(accessor, "its buffer is missing");
    const std::string_view bytes = buffer_bytes(buffer, accessor);
    const std::uint64_t begin = whole(view, "byteOffset", 0, accessor);
    const std::uint64_t length = whole(view, "byteLength", 0, accessor);
    if (begin > bytes.size() || length > bytes.size() - begin) {
      refuse(accessor, fmt::format("its buffer is truncated: has {} bytes", bytes.size()));
    }
    return bytes.substr(begin, length);
  }

  std::string_view buffer_bytes(std::uint64_t buffer, std::size_t accessor) {
    if (const auto known = buffers_.find(buffer); known != buffers_.end()) return known->second;
    const json& owner = list("buffers")[buffer];
    if (!owner.is_object() || !owner.contains("uri") || !owner["uri"].is_string()) {
      if (buffer != 0 || file_.format != MeshFormat::kGlb) refuse(accessor, "its buffer has no uri");
      return second_chunk();
    }
    const auto& name = owner["uri"].get_ref<const std::string&>();
    std::string& bytes = buffers_[buffer];
    if (!name.starts_with("data:")) {
      bytes = InputFile(file_.path.parent_path() / to_path(name), kMeshInput).read_rest();
      return bytes;
    }
    constexpr std::string_view kMark = ";base64,";
    const std::size_t mark = name.find(kMark);
    if (mark == std::string::npos) refuse(accessor, "its buffer must be in base 64");
    bytes = base64_decoded(std::string_view(name).substr(mark + kMark.size()));
    return bytes;
  }

  /// Offset of the first byte behind the JSON chunk of a .glb file.
  [[nodiscard]] std::size_t json_end() const {
    return static_cast<std::size_t>(json_.data() - file_.bytes.data()) + json_.size();
  }

  /// The content of a .glb file's second chunk, which is its first buffer.
  [[nodiscard]] std::string_view second_chunk() const {
    constexpr std::size_t kHead = 8;
    const std::string_view rest = std::string_view(file_.bytes).substr(json_end());
    if (rest.size() < kHead) return {};
    return rest.substr(kHead, little_endian_32(rest, 0));
  }

  /// A file with another JSON text.
  [[nodiscard]] std::string packed(std::string text) const {
    if (file_.format != MeshFormat::kGlb) return text;
    constexpr std::size_t kAlignment = 4;
    text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
    const std::string_view old = file_.bytes;
    const auto number = [](std::size_t value) {
      const auto whole = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&whole), sizeof whole);
    };
    const std::string_view rest = old.substr(json_end());
    constexpr std::size_t kHeads = 20;
    return std::string(old.substr(0, 8)) + number(kHeads + text.size() + rest.size()) + number(text.size()) +
           std::string(old.substr(16, 4)) + text + std::string(rest);
  }

  const MeshFile& file_;
  std::string_view json_;
  json root_;
  std::map<std::uint64_t, std::string> buffers_;  // decoded ones by index
  std::map<std::size_t, std::size_t> offsets_;    // of converted accessors: of their floats
  std::string floats_;
  std::uint64_t vertices_ = 0;
};

}  // namespace

MeshFile with_float_positions(const MeshFile& file) { return FloatPositions(file).run(); }

}  // namespace palpate::mesh_io
