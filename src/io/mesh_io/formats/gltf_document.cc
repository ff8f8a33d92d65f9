#include "io/mesh_io/formats/gltf_document.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/scan.h"
#include "io/system/base64.h"
#include "io/system/input_file.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

using Json = GltfDocument::Json;

constexpr std::uint64_t kMostWithoutBuffer = 1'000'000;  // elements
constexpr std::uint64_t kLongestStride = 252;            // bytes, of the format
constexpr std::size_t kGlbHeader = 20;                   // bytes: 12 of the file, 8 of its first chunk
constexpr const char* kQuantized = "KHR_mesh_quantization";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr std::array kMeshopt = {"EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression"};
constexpr const char* kInstances = "EXT_mesh_gpu_instancing";

/// The JSON chunk of a .glb file, which is the first one.
std::string_view json_of_glb(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  const auto reject = [&](const std::string& message) {
    throw InputError(to_text(file.path) + ": " + message);
  };
  if (bytes.size() < kGlbHeader || bytes.substr(0, 4) != "glTF") {
    reject("not a binary glTF: must start with \"glTF\" and a JSON chunk");
  }
  const std::size_t declared = little_endian_32(bytes, 8);
  if (declared != bytes.size()) {
    reject(fmt::format("truncated or damaged: declares {} bytes, has {}", declared, bytes.size()));
  }
  const std::size_t length = little_endian_32(bytes, 12);
  if (length > bytes.size() - kGlbHeader) reject("truncated: its JSON chunk does not end");
  return bytes.substr(kGlbHeader, length);
}

/// Extensions of materials, lights and the like, which change no vertex.
bool changes_no_vertex(std::string_view extension) {
  constexpr std::array<std::string_view, 8> kStarts = {
      "KHR_materials_", "KHR_texture_",  "KHR_lights_",           "KHR_xmp",
      "EXT_texture_",   "MSFT_texture_", "KHR_animation_pointer", "EXT_lights_"};
  return std::any_of(kStarts.begin(), kStarts.end(),
                     [&](std::string_view start) { return extension.starts_with(start); });
}

bool has_extension(const Json& owner, const char* name) {
  if (!owner.is_object()) return false;
  const auto extensions = owner.find("extensions");
  return extensions != owner.end() && extensions->is_object() && extensions->contains(name);
}

/// A uri without percent-encoding [RFC 3986, section 2.1]; a zero byte is kept encoded.
std::string decoded(std::string_view uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char low = static_cast<char>(c | 0x20);
    return low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
  };
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool two = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    const int byte = two ? 16 * digit(uri[i + 1]) + digit(uri[i + 2]) : 0;
    name += byte > 0 ? static_cast<char>(byte) : uri[i];
    if (byte > 0) i += 2;
  }
  return name;
}

template <typename T>
double gltf_component(const char* bytes, bool normalized) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  const auto number = static_cast<double>(value);
  if (!normalized) return number;
  return std::max(-1.0, number / static_cast<double>(std::numeric_limits<T>::max()));
}

struct ComponentType {
  std::uint64_t gltf;  // glTF's number of the type
  std::size_t bytes;
  double (*read)(const char* bytes, bool normalized);
};

constexpr std::array<ComponentType, 6> kComponents = {{{5120, 1, gltf_component<std::int8_t>},
                                                       {5121, 1, gltf_component<std::uint8_t>},
                                                       {5122, 2, gltf_component<std::int16_t>},
                                                       {5123, 2, gltf_component<std::uint16_t>},
                                                       {5125, 4, gltf_component<std::uint32_t>},
                                                       {5126, 4, gltf_component<float>}}};

std::size_t numbers_in(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 16;  // MAT4
}

}  // namespace

/// How the numbers of an accessor are stored.
struct GltfDocument::Layout {
  std::size_t bytes = 0;  // of a component
  double (*number)(const char* bytes, bool normalized) = nullptr;
  std::size_t components = 0;  // of an element
  bool normalized = false;
};

GltfDocument::GltfDocument(const MeshFile& file)
    : file_(file), text_(file.format == MeshFormat::kGlb ? json_of_glb(file) : std::string_view(file.bytes)) {
  try {
    root_ = parse_json(text_);
  } catch (const InputError& error) {
    refuse(std::string("its JSON: ") + error.what());
  }
  if (!root_.is_object()) refuse("its JSON: must be an object");
  const auto asset = root_.find("asset");
  if (asset == root_.end() || !asset->is_object()) return;
  const auto version = asset->find("version");
  if (version == asset->end() || !version->is_string()) return;
  const std::string text = version->get<std::string>();
  if (!text.starts_with("2.")) refuse("is glTF " + excerpt(text) + ", must be 2.0: export it again");
}

void GltfDocument::spend(std::uint64_t elements) {
  elements_ += elements;
  if (elements_ <= kMaxElements) return;
  refuse(fmt::format("its parts declare more than {} indices and vertices", kMaxElements));
}

void GltfDocument::refuse(const std::string& message) const {
  throw InputError(to_text(file_.path) + ": " + message);
}

void GltfDocument::refuse_accessor(std::uint64_t accessor, const std::string& message) const {
  refuse(fmt::format("accessor {}: {}", accessor, message));
}

const Json& GltfDocument::list_in(const Json& owner, const char* name) {
  static const Json kNone = Json::array();
  if (!owner.is_object()) return kNone;
  const auto found = owner.find(name);
  return found != owner.end() && found->is_array() ? *found : kNone;
}

std::uint64_t GltfDocument::whole(const Json& owner, const char* name, std::uint64_t otherwise,
                                  std::string_view where) const {
  if (!owner.is_object()) refuse(fmt::format("{}: must be an object", where));
  const auto found = owner.find(name);
  if (found == owner.end()) return otherwise;
  if (found->is_number_unsigned()) return found->get<std::uint64_t>();
  refuse(fmt::format("{}: {} must be a whole number", where, name));
}

std::vector<std::string> GltfDocument::buffer_names() const {
  std::vector<std::string> names;
  for (const Json& buffer : list("buffers")) {
    if (!buffer.is_object()) continue;
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    const std::string name = uri->get<std::string>();
    if (!name.starts_with("data:")) names.push_back(decoded(name));
  }
  return names;
}

void GltfDocument::check() const {
  check_extensions();
  check_buffers();
}

void GltfDocument::refuse_extension(const std::string& name) const {
  const std::string text = excerpt(name);
  if (name == kDraco) {
    refuse("its mesh is compressed by Draco (" + text +
           "), which is not read: export it without compression");
  }
  if (std::find(kMeshopt.begin(), kMeshopt.end(), name) != kMeshopt.end()) {
    refuse("its mesh is compressed by meshopt (" + text +
           "), which is not read: export it without compression (gltfpack without -c)");
  }
  refuse("needs the glTF extension " + text + ", which is not read: export it without, or as STL or PLY");
}

/// Extensions that a file requires, and those that it only uses where their data have no other form.
void GltfDocument::check_extensions() const {
  for (const Json& name : list("extensionsRequired")) {
    if (!name.is_string()) continue;
    const std::string text = name.get<std::string>();
    if (text != kQuantized && !changes_no_vertex(text)) refuse_extension(text);
  }
  for (const Json& node : list("nodes")) {
    if (has_extension(node, kInstances)) refuse_extension(kInstances);
  }
  for (const Json& mesh : list("meshes")) {
    for (const Json& part : list_in(mesh, "primitives")) check_part_extensions(part);
  }
  for (const Json& buffer : list("buffers")) {
    for (const char* name : kMeshopt) {
      if (has_extension(buffer, name) && !buffer.contains("uri")) refuse_extension(name);
    }
  }
}

void GltfDocument::check_part_extensions(const Json& part) const {
  if (!has_extension(part, kDraco)) return;
  const auto attributes = part.find("attributes");
  const Json& accessors = list("accessors");
  if (attributes != part.end() && attributes->is_object()) {
    const std::uint64_t position = whole(*attributes, "POSITION", accessors.size(), "a part's attributes");
    if (position < accessors.size() && accessors[position].is_object() &&
        accessors[position].contains("bufferView"))
      return;
  }
  refuse_extension(kDraco);
}

/// Whether a symbolic link in the mesh's folder leads outside it.
bool GltfDocument::leads_out(const std::string& name) const {
  std::error_code error;
  const std::filesystem::path folder =
      std::filesystem::weakly_canonical(std::filesystem::absolute(file_.path, error).parent_path(), error);
  const std::filesystem::path inside =
      std::filesystem::weakly_canonical(folder / to_path(name).lexically_normal(), error)
          .lexically_relative(folder);
  return error || inside.empty() || *inside.begin() == "..";
}

/// A buffer in its own file must be in or below the mesh file's folder; no other file is opened.
void GltfDocument::check_buffers() const {
  std::uintmax_t bytes = 0;
  for (const std::string& name : buffer_names()) {
    const std::filesystem::path path = to_path(name).lexically_normal();
    const bool leaves = path.is_absolute() || path.empty() || *path.begin() == ".." ||
                        name.find(':') != std::string::npos || leads_out(name);
    if (leaves) refuse("buffer \"" + excerpt(name) + "\": must be a file in the folder of the mesh");
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file_.path.parent_path() / path, error);
    if (!error) bytes += size;  // a missing file is reported when it is read
    if (bytes > kMeshInput.max_bytes) {
      refuse(fmt::format("buffer \"{}\": its buffers have more than {} MiB in all", excerpt(name),
                         kMeshInput.max_bytes >> 20U));
    }
  }
}

std::vector<double> GltfDocument::numbers(std::uint64_t index, std::string_view type) {
  const Json& accessors = list("accessors");
  if (index >= accessors.size() || !accessors[index].is_object()) {
    refuse(fmt::format("accessor {} is named but not there: it has {}", index, accessors.size()));
  }
  const Json& accessor = accessors[index];
  const std::string where = fmt::format("accessor {}", index);
  const std::uint64_t number = whole(accessor, "componentType", 0, where);
  const auto* const known = std::find_if(kComponents.begin(), kComponents.end(),
                                         [&](const ComponentType& one) { return one.gltf == number; });
  if (known == kComponents.end()) {
    refuse_accessor(index,
                    fmt::format("componentType {}: must be 5120, 5121, 5122, 5123, 5125 or 5126", number));
  }
  const auto given = accessor.find("type");
  if (given == accessor.end() || *given != Json(std::string(type)))
    refuse_accessor(index, fmt::format("its type must be {}", type));
  const auto normalized = accessor.find("normalized");
  const Layout layout{known->bytes, known->read, numbers_in(type),
                      normalized != accessor.end() && *normalized == Json(true) && number != 5126};
  const std::uint64_t count = whole(accessor, "count", 0, where);
  if (count == 0 || count > kMaxElements) {
    refuse_accessor(index, fmt::format("count {}: must be 1 to {}", count, kMaxElements));
  }
  spend(count);
  std::vector<double> values;
  const auto sparse = accessor.find("sparse");
  if (accessor.contains("bufferView")) {
    read(layout, accessor, index, count, values);
  } else if (sparse == accessor.end()) {
    refuse_accessor(index, "has no bufferView: its values are without a buffer");
  } else if (count > kMostWithoutBuffer) {
    refuse_accessor(
        index, fmt::format("{} elements without a buffer: must be at most {}", count, kMostWithoutBuffer));
  } else {
    values.assign(count * layout.components, 0.0);
  }
  if (sparse != accessor.end()) read_sparse(layout, *sparse, index, values);
  return values;
}

/// Reads `count` elements from the bufferView of `owner`.
void GltfDocument::read(const Layout& layout, const Json& owner, std::uint64_t accessor, std::uint64_t count,
                        std::vector<double>& values) {
  const std::string where = fmt::format("accessor {}", accessor);
  const Json& views = list("bufferViews");
  const std::uint64_t view_index = whole(owner, "bufferView", views.size(), where);
  if (view_index >= views.size() || !views[view_index].is_object()) {
    refuse_accessor(accessor, "has no bufferView of this file");
  }
  const Json& view = views[view_index];
  const std::uint64_t size = layout.components * layout.bytes;
  const std::uint64_t stride = whole(view, "byteStride", size, where);
  const std::string_view bytes = view_bytes(view, accessor);
  const std::uint64_t begin = whole(owner, "byteOffset", 0, where);
  const bool fits = stride >= size && (stride <= kLongestStride || stride == size) && begin <= bytes.size() &&
                    (count - 1) * stride + size <= bytes.size() - begin;
  if (!fits) {
    refuse_accessor(accessor, fmt::format("{} elements do not fit in its {} bytes", count, bytes.size()));
  }
  values.reserve(count * layout.components);
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* element = bytes.data() + begin + i * stride;
    for (std::size_t k = 0; k < layout.components; ++k)
      values.push_back(layout.number(element + k * layout.bytes, layout.normalized));
  }
}

/// Replaces some elements by others.
void GltfDocument::read_sparse(const Layout& layout, const Json& sparse, std::uint64_t accessor,
                               std::vector<double>& values) {
  const std::string where = fmt::format("accessor {}", accessor);
  const std::uint64_t count = whole(sparse, "count", 0, where);
  if (count == 0 || count > values.size() / layout.components || !sparse.contains("indices") ||
      !sparse.contains("values")) {
    refuse_accessor(accessor, "its sparse values must have a count of 1 to its own, indices and values");
  }
  const std::uint64_t type = whole(sparse["indices"], "componentType", 0, where);
  const auto* const known = std::find_if(kComponents.begin(), kComponents.end(),
                                         [&](const ComponentType& one) { return one.gltf == type; });
  if (type != 5121 && type != 5123 && type != 5125) {
    refuse_accessor(accessor, "its sparse indices must have the componentType 5121, 5123 or 5125");
  }
  std::vector<double> places;
  std::vector<double> others;
  read({known->bytes, known->read, 1, false}, sparse["indices"], accessor, count, places);
  read(layout, sparse["values"], accessor, count, others);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto place = static_cast<std::uint64_t>(places[i]);
    if (place >= values.size() / layout.components) {
      refuse_accessor(accessor, fmt::format("its sparse index {} is out of range", place));
    }
    std::copy_n(others.begin() + static_cast<std::ptrdiff_t>(i * layout.components), layout.components,
                values.begin() + static_cast<std::ptrdiff_t>(place * layout.components));
  }
}

std::string_view GltfDocument::view_bytes(const Json& view, std::uint64_t accessor) {
  const std::string where = fmt::format("accessor {}", accessor);
  const Json& buffers = list("buffers");
  const std::uint64_t buffer = whole(view, "buffer", buffers.size(), where);
  if (buffer >= buffers.size()) refuse_accessor(accessor, "its buffer is missing");
  const std::string_view bytes = buffer_bytes(buffer, accessor);
  const std::uint64_t begin = whole(view, "byteOffset", 0, where);
  const std::uint64_t length = whole(view, "byteLength", 0, where);
  if (begin > bytes.size() || length > bytes.size() - begin) {
    refuse_accessor(accessor, fmt::format("its buffer is truncated: has {} bytes", bytes.size()));
  }
  return bytes.substr(begin, length);
}

std::string_view GltfDocument::buffer_bytes(std::uint64_t buffer, std::uint64_t accessor) {
  if (const auto known = buffers_.find(buffer); known != buffers_.end()) return known->second;
  const Json& owner = list("buffers")[buffer];
  if (!owner.is_object() || !owner.contains("uri") || !owner["uri"].is_string()) {
    if (buffer != 0 || file_.format != MeshFormat::kGlb) {
      refuse_accessor(accessor, fmt::format("buffer {} has no uri", buffer));
    }
    // The second chunk of a .glb file, behind the JSON.
    constexpr std::size_t kHead = 8;
    const auto json_end = static_cast<std::size_t>(text_.data() - file_.bytes.data()) + text_.size();
    const std::string_view rest = std::string_view(file_.bytes).substr(json_end);
    return rest.size() < kHead ? std::string_view() : rest.substr(kHead, little_endian_32(rest, 0));
  }
  const auto& name = owner["uri"].get_ref<const std::string&>();
  std::string& bytes = buffers_[buffer];
  if (!name.starts_with("data:")) {
    try {
      bytes = InputFile(file_.path.parent_path() / to_path(decoded(name)), kMeshInput).read_rest();
    } catch (const InputError& error) {
      refuse(fmt::format("buffer \"{}\": {}", excerpt(name), error.what()));
    }
    return bytes;
  }
  constexpr std::string_view kMark = ";base64,";
  const std::size_t mark = name.find(kMark);
  if (mark == std::string::npos) {
    refuse_accessor(accessor, fmt::format("buffer {} must be in base 64", buffer));
  }
  bytes = base64_decoded(std::string_view(name).substr(mark + kMark.size()));
  return bytes;
}

}  // namespace palpate::mesh_io
