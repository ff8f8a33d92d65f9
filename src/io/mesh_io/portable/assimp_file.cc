// Formats that are read by assimp, in a build without it.
#include "io/mesh_io/formats/formats.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

[[noreturn]] ImportedMesh refuse_format(const MeshFile& file, const char* format) {
  throw InputError(to_text(file.path) + ": this build of palpate does not read " + format +
                   ", must be .stl, .obj, .ply, .off, .vtk or .msh");
}

}  // namespace

ImportedMesh read_3ds(const MeshFile& file) { return refuse_format(file, "3DS"); }
ImportedMesh read_gltf(const MeshFile& file) { return refuse_format(file, "glTF"); }

std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& /*mesh*/) { return {}; }

}  // namespace palpate::mesh_io
