#include "io/mesh_io/formats/gltf_check.h"

#include <algorithm>
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
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::geometry {
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

std::string_view json_text(const MeshFile& file) {
  return file.format == MeshFormat::kGlb ? json_of_glb(file) : std::string_view(file.bytes);
}

class GltfCheck final {
 public:
  GltfCheck(const MeshFile& file, std::string_view text) : file_(file), text_(text) {}

  void run() {
    parse();
    check_nodes();
    check_buffers();
    check_accessors();
    check_parts();
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

  /// A buffer in its own file must be in or below the mesh file's folder; no other file is opened.
  void check_buffers() const {
    for (const std::string& name : buffer_names()) {
      const std::filesystem::path path = to_path(name).lexically_normal();
      const bool leaves = path.is_absolute() || path.empty() || *path.begin() == ".." ||
                          name.find(':') != std::string::npos || hides_a_path(name) || leads_out(path);
      if (leaves) {
        refuse("buffer \"" + excerpt(name) + "\": must be a file in the folder of the mesh");
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

void check_gltf(const MeshFile& file) { GltfCheck(file, json_text(file)).run(); }

std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh) {
  const std::optional<MeshFormat> format = mesh_format(mesh);
  if (format != MeshFormat::kGltf && format != MeshFormat::kGlb) return {};
  const MeshFile file = open_mesh_file(mesh);
  GltfCheck check(file, json_text(file));
  check.parse();
  std::vector<std::filesystem::path> files;
  for (const std::string& name : check.buffer_names()) files.push_back(mesh.parent_path() / name);
  return files;
}

}  // namespace palpate::geometry
