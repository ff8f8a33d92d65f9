// glTF in a build without a JSON library.
#include "io/mesh_io/formats/formats.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {

ImportedMesh read_gltf(const MeshFile& file) {
  throw InputError(to_text(file.path) +
                   ": this build of palpate does not read glTF: export it as .stl, .obj or .ply");
}

std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& /*mesh*/) { return {}; }

}  // namespace palpate::mesh_io
