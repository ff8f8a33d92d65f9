// Mesh files of the format PALPATE_FUZZ_ENDING: read and repaired to an organ, or rejected with a message.
#include <utility>

#include "io/mesh_io/repair/repair.h"
#include "palpate/read_mesh.h"

#include "fuzz/input.h"

namespace {

using namespace palpate;

void require_sound(const geometry::TriangleMesh& mesh) {
  for (const Vec3& vertex : mesh.vertices) fuzz::require(vertex.allFinite(), "vertices are finite");
  for (const geometry::Triangle& triangle : mesh.triangles) {
    for (const std::int32_t v : triangle) {
      fuzz::require(v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size(), "indices are in range");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile input(PALPATE_FUZZ_ENDING);
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    mesh_io::LoadedMesh loaded = mesh_io::read_mesh(file, LengthUnit::kMillimetre);
    require_sound(loaded.mesh);
    // repair_organ() also rejects meshes by size, so repair_surface() is called first.
    const mesh_io::RepairedSurface repaired = mesh_io::repair_surface(loaded.mesh);
    require_sound(repaired.mesh);
    loaded = mesh_io::repair_organ(std::move(loaded), file.string());
    require_sound(loaded.mesh);
    fuzz::require(loaded.findings.closed && loaded.findings.manifold, "an organ is closed and manifold");
  });
  return 0;
}
