// STL files as a tool's part: sampled into contact points, or rejected with a message.
#include <cmath>
#include <utility>

#include "core/contact/tool_points.h"
#include "palpate/read_mesh.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  constexpr double kLargest = 0.05;  // m: larger tools take seconds and find nothing new
  static const fuzz::InputFile input(".stl");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    mesh_io::LoadedMesh loaded = mesh_io::read_mesh(file, LengthUnit::kMillimetre);
    if (geometry::bounds(loaded.mesh).size().maxCoeff() > kLargest) return;
    geometry::ToolPart part;
    part.name = file.string();
    part.mesh = std::move(loaded.mesh);
    const contact::PartPoints points = contact::sample_part(part, 0.0);
    fuzz::require(points.size() > 0 && points.size() <= contact::PartPoints::kMaxPoints, "a tool has points");
    for (const auto* values :
         {&points.x, &points.y, &points.z, &points.tip_radius, &points.half_width, &points.area}) {
      for (const double x : *values) fuzz::require(std::isfinite(x), "a tool's points are finite");
    }
  });
  return 0;
}
