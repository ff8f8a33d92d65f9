#include "io/mesh_io/formats/gltf_check.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/mesh_io/formats/scan.h"
#include "io/system/input_file.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

using nlohmann::json;

constexpr int kDeepestGltfNode = 200;
constexpr std::size_t kMaxNodes = 100'000;
constexpr std::uint64_t kMaxElements = 20'000'000;       // indices and vertices of all parts
constexpr std::uint64_t kMaxWithoutBuffer = 10'000'000;  // values that have a count but no buffer

/// The JSON chunk of a .glb file, which is the first one.
std::string_view json_of_glb(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  const auto refuse = [&](const std::string& message) {
    throw InputError(to_text(file.path) + ": " + message);
  };
  constexpr std::size_t kHeader = 20;  // 12 bytes of the file, 8 of the chunk
  if (bytes.size() < kHeader || bytes.substr(0, 4) != "glTF") {
    refuse("not a binary glTF: must start with \"glTF\" and a JSON chunk");
  }
  const std::size_t declared = little_endian_32(bytes, 8);
  if (declared != bytes.size()) {
    refuse(fmt::format("truncated or damaged: declares {} bytes, has {}", declared, bytes.size()));
  }
  const std::size_t length = little_endian_32(bytes, 12);
  if (length > bytes.size() - kHeader) refuse("truncated: its JSON chunk does not end");
  return bytes.substr(kHeader, length);
}

/// Extensions of materials, lights and the like, which change no vertex.
bool changes_no_vertex(std::string_view extension) {
  constexpr std::array<std::string_view, 8> kStarts = {
      "KHR_materials_", "KHR_texture_",  "KHR_lights_",           "KHR_xmp",
      "EXT_texture_",   "MSFT_texture_", "KHR_animation_pointer", "EXT_lights_"};
  return std::any_of(kStarts.begin(), kStarts.end(),
                     [&](std::string_view start) { return extension.starts_with(start); });
}

constexpr const char* kQuantized = "KHR_mesh_quantization";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr std::array kMeshopt = {"EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression"};
constexpr const char* kInstances = "EXT_mesh_gpu_instancing";

class GltfCheck final {
 public:
  GltfCheck(const MeshFile& file, std::string_view text) : file_(file), text_(text) {}

  bool run() {
    parse();
    check_extensions();
    check_nodes();
    check_buffers();
    check_accessors();
    check_parts();
    return has_quantized_positions();
  }

  void parse() {
    try {
      root_ = parse_json(text_);
    } catch (const InputError& error) {
      refuse(std::string("its JSON: ") + error.what());
    }
    if (!root_.is_object()) refuse("its JSON: must be an object");
  }

  /// The names of the buffers that are separate files.
  [[nodiscard]] std::vector<std::string> buffer_names() const {
    std::vector<std::string> names;
    for (const json& buffer : list(root_, "buffers")) {
      if (!buffer.is_object()) continue;
      const auto uri = buffer.find("uri");
      if (uri == buffer.end() || !uri->is_string()) continue;
      const std::string name = uri->get<std::string>();
      if (!name.starts_with("data:")) names.push_back(name);
    }
    return names;
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(to_text(file_.path) + ": " + message);
  }

  [[nodiscard]] const json& list(const json& owner, const char* name) const {
    static const json kNone = json::array();
    if (!owner.is_object()) return kNone;
    const auto found = owner.find(name);
    return found != owner.end() && found->is_array() ? *found : kNone;
  }

  [[noreturn]] void refuse_extension(const std::string& name) const {
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

  static bool has_extension(const json& owner, const char* name) {
    if (!owner.is_object()) return false;
    const auto extensions = owner.find("extensions");
    return extensions != owner.end() && extensions->is_object() && extensions->contains(name);
  }

  /// The accessor of a part's vertices; null: none.
  [[nodiscard]] const json* positions_of(const json& part) const {
    if (!part.is_object()) return nullptr;
    const auto attributes = part.find("attributes");
    if (attributes == part.end() || !attributes->is_object()) return nullptr;
    const auto index = attributes->find("POSITION");
    const json& accessors = list(root_, "accessors");
    if (index == attributes->end() || !index->is_number_unsigned()) return nullptr;
    if (index->get<std::uint64_t>() >= accessors.size()) return nullptr;  // the importer reports it
    return &accessors[index->get<std::size_t>()];
  }

  template <typename Use>
  void for_each_part(const Use& use) const {
    for (const json& mesh : list(root_, "meshes")) {
      for (const json& part : list(mesh, "primitives")) use(part);
    }
  }

  /// Extensions that a file requires, and those that it only uses where their data have no other form. The
  /// importer ignores them, and would read other vertices.
  void check_extensions() const {
    for (const json& name : list(root_, "extensionsRequired")) {
      if (!name.is_string()) continue;
      const std::string text = name.get<std::string>();
      if (text != kQuantized && !changes_no_vertex(text)) refuse_extension(text);
    }
    for (const json& node : list(root_, "nodes")) {
      if (has_extension(node, kInstances)) refuse_extension(kInstances);
    }
    for_each_part([&](const json& part) {
      const json* const positions = positions_of(part);
      const bool is_elsewhere = positions == nullptr || !positions->contains("bufferView");
      if (is_elsewhere && has_extension(part, kDraco)) refuse_extension(kDraco);
    });
    for (const json& buffer : list(root_, "buffers")) {
      for (const char* name : kMeshopt) {
        if (has_extension(buffer, name) && !buffer.contains("uri")) refuse_extension(name);
      }
    }
  }

  [[nodiscard]] bool has_quantized_positions() const {
    constexpr int kFloat = 5126;
    bool any = false;
    for_each_part([&](const json& part) {
      const json* const positions = positions_of(part);
      if (positions == nullptr || !positions->is_object()) return;
      const auto type = positions->find("componentType");
      any = any || (type != positions->end() && *type != kFloat);
    });
    return any;
  }

  /// Visits the tree of nodes like an importer, a node once per use.
  void check_nodes() const {
    const json& nodes = list(root_, "nodes");
    std::vector<std::pair<std::size_t, int>> open;  // node, depth
    std::size_t used = 0;
    const auto add = [&](const json& indices, int depth) {
      for (const json& index : indices) {
        if (++used > kMaxNodes) refuse(fmt::format("its nodes are used more than {} times", kMaxNodes));
        if (!index.is_number_unsigned()) continue;  // the importer reports it
        if (index.get<std::uint64_t>() < nodes.size()) open.emplace_back(index.get<std::size_t>(), depth);
      }
    };
    for (const json& scene : list(root_, "scenes")) add(list(scene, "nodes"), 1);
    while (!open.empty()) {
      const auto [node, depth] = open.back();
      open.pop_back();
      if (depth > kDeepestGltfNode)
        refuse(fmt::format("its nodes are nested more than {} deep", kDeepestGltfNode));
      add(list(nodes[node], "children"), depth + 1);
    }
  }

  /// Whether the name has percent-encoded dots or slashes.
  static bool hides_a_path(const std::string& name) {
    for (std::size_t at = name.find("%2"); at != std::string::npos; at = name.find("%2", at + 1)) {
      if (at + 2 < name.size() && std::string_view("eEfF").find(name[at + 2]) != std::string_view::npos)
        return true;
    }
    return false;
  }

  /// Whether a symbolic link in the mesh's folder leads outside it.
  [[nodiscard]] bool leads_out(const std::filesystem::path& name) const {
    std::error_code error;
    const std::filesystem::path folder =
        std::filesystem::weakly_canonical(std::filesystem::absolute(file_.path, error).parent_path(), error);
    const std::filesystem::path inside =
        std::filesystem::weakly_canonical(folder / name, error).lexically_relative(folder);
    return error || inside.empty() || *inside.begin() == "..";
  }

  /// A buffer in its own file must be in or below the mesh file's folder; no other file is opened. Readers
  /// hold all buffers in memory at once, and a file once for each buffer that names it.
  void check_buffers() const {
    std::uintmax_t bytes = 0;
    for (const std::string& name : buffer_names()) {
      const std::filesystem::path path = to_path(name).lexically_normal();
      const bool leaves = path.is_absolute() || path.empty() || *path.begin() == ".." ||
                          name.find(':') != std::string::npos || hides_a_path(name) || leads_out(path);
      if (leaves) {
        refuse("buffer \"" + excerpt(name) + "\": must be a file in the folder of the mesh");
      }
      std::error_code error;
      const std::uintmax_t size = std::filesystem::file_size(file_.path.parent_path() / path, error);
      if (!error) bytes += size;  // the importer reports a missing file
      if (bytes > kMeshInput.max_bytes) {
        refuse(fmt::format("buffer \"{}\": its buffers have more than {} MiB in all", excerpt(name),
                           kMeshInput.max_bytes >> 20U));
      }
    }
  }

  /// The number of elements that an accessor declares, 0 if it is no number; at most `most`.
  static std::uint64_t count_of(const json& accessor, std::uint64_t most) {
    const auto count = accessor.is_object() ? accessor.find("count") : accessor.end();
    if (count == accessor.end() || !count->is_number_unsigned()) return 0;
    return std::min(count->get<std::uint64_t>(), most);
  }

  void check_accessors() const {
    std::uint64_t without_buffer = 0;
    for (const json& accessor : list(root_, "accessors")) {
      if (accessor.is_object() && accessor.contains("bufferView")) continue;
      without_buffer += count_of(accessor, kMaxWithoutBuffer + 1);
      if (without_buffer > kMaxWithoutBuffer) {
        refuse(fmt::format("accessors without a buffer declare more than {} elements", kMaxWithoutBuffer));
      }
    }
  }

  /// The importer copies indices and vertices of each part, even if parts share them.
  void check_parts() const {
    const json& accessors = list(root_, "accessors");
    std::uint64_t elements = 0;
    const auto add = [&](const json& index) {
      if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= accessors.size()) return;
      elements += count_of(accessors[index.get<std::size_t>()], kMaxElements + 1);
      if (elements <= kMaxElements) return;
      refuse(fmt::format("its parts declare more than {} indices and vertices", kMaxElements));
    };
    for (const json& mesh : list(root_, "meshes")) {
      for (const json& part : list(mesh, "primitives")) {
        if (!part.is_object()) continue;
        if (const auto indices = part.find("indices"); indices != part.end()) add(*indices);
        const auto attributes = part.find("attributes");
        if (attributes == part.end() || !attributes->is_object()) continue;
        for (const json& attribute : *attributes) add(attribute);
      }
    }
  }

  const MeshFile& file_;
  std::string_view text_;
  json root_;
};

}  // namespace

std::string_view gltf_json_text(const MeshFile& file) {
  return file.format == MeshFormat::kGlb ? json_of_glb(file) : std::string_view(file.bytes);
}

bool check_gltf(const MeshFile& file) { return GltfCheck(file, gltf_json_text(file)).run(); }

std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh) {
  const std::optional<MeshFormat> format = mesh_format(mesh);
  if (format != MeshFormat::kGltf && format != MeshFormat::kGlb) return {};
  const MeshFile file = open_mesh_file(mesh);
  GltfCheck check(file, gltf_json_text(file));
  check.parse();
  std::vector<std::filesystem::path> files;
  for (const std::string& name : check.buffer_names()) files.push_back(mesh.parent_path() / name);
  return files;
}

}  // namespace palpate::mesh_io
