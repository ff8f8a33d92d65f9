// Palpation maps from CSV. The rows of a map that is read are finite, with depths of at least 0.
#include <cmath>

#include "fit/identify/map_fit.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    for (const identify::MapRow& row : identify::read_map(file)) {
      fuzz::require(row.point.allFinite() && row.normal.allFinite(), "points and normals are finite");
      fuzz::require(row.depth >= 0.0 && std::isfinite(row.depth), "a depth is at least 0");
      fuzz::require(std::isfinite(row.force), "a force is finite");
    }
  });
  return 0;
}
