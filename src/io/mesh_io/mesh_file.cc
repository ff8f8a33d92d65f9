#include "io/mesh_io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/system/file_content.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"

namespace palpate::geometry {
namespace {

struct Reader {
  std::string_view ending;
  MeshFormat format;
  ImportedMesh (*read)(const MeshFile& file);
};

constexpr std::array<Reader, 9> kReaders{{{".stl", MeshFormat::kStl, read_stl},
                                          {".obj", MeshFormat::kObj, read_obj},
                                          {".ply", MeshFormat::kPly, read_ply},
                                          {".off", MeshFormat::kOff, read_off},
                                          {".3ds", MeshFormat::k3ds, read_3ds},
                                          {".gltf", MeshFormat::kGltf, read_gltf},
                                          {".glb", MeshFormat::kGlb, read_gltf},
                                          {".vtk", MeshFormat::kVtk, read_vtk},
                                          {".msh", MeshFormat::kMsh, read_msh}}};

/// @throws InputError for a mesh of another format than its name's extension says
void refuse_other_format(const MeshFile& file) {
  const ContentFacts found = find_content(file.path);
  if (found.content != FileContent::kMesh || mesh_format("a" + found.extension) == file.format) return;
  throw InputError(
      fmt::format("{}: is {}: its name must end in {}", to_text(file.path), found.name, found.extension));
}

}  // namespace

std::vector<std::string> mesh_file_extensions() {
  std::vector<std::string> endings;
  for (const Reader& reader : kReaders) endings.emplace_back(reader.ending);
  return endings;
}

std::optional<MeshFormat> mesh_format(const std::filesystem::path& path) {
  std::string ending = to_text(path.extension());
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Reader& reader : kReaders) {
    if (reader.ending == ending) return reader.format;
  }
  return std::nullopt;
}

bool is_mesh_file(const std::filesystem::path& path) { return mesh_format(path).has_value(); }

MeshFile open_mesh_file(const std::filesystem::path& path) {
  InputFile input(path, kMeshInput);
  const std::optional<MeshFormat> format = mesh_format(path);
  if (!format) {
    refuse_other_content(path, FileContent::kMesh, "a mesh file");
    throw InputError(fmt::format("{}: unknown file name extension \"{}\": must be one of {}", to_text(path),
                                 to_text(path.extension()), joined(mesh_file_extensions())));
  }
  MeshFile file{path, *format, input.read_rest()};
  if (file.bytes.empty()) throw InputError(to_text(path) + ": empty");
  return file;
}

ImportedMesh import_mesh(const MeshFile& file) {
  const auto* const reader = std::find_if(kReaders.begin(), kReaders.end(),
                                          [&](const Reader& known) { return known.format == file.format; });
  try {
    return reader->read(file);
  } catch (const InputError&) {
    refuse_other_content(file.path, FileContent::kMesh, "a mesh file");
    refuse_other_format(file);
    throw;
  }
}

}  // namespace palpate::geometry
