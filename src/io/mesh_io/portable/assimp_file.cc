// 3DS in a build without assimp.
#include "io/mesh_io/formats/formats.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {

ImportedMesh read_3ds(const MeshFile& file) {
  throw InputError(to_text(file.path) +
                   ": this build of palpate does not read 3DS: export it as .stl, .obj or .ply");
}

}  // namespace palpate::mesh_io
