// Stiffness maps from CSV and, where the input begins with "ply", from PLY. A map that is read has finite
// points and factors within their limits.
#include <string_view>

#include "io/scene/stiffness_map_reader.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile csv(".csv");
  static const fuzz::InputFile ply(".ply");
  const bool is_ply = std::string_view(reinterpret_cast<const char*>(data), size).starts_with("ply");
  const std::filesystem::path& file = (is_ply ? ply : csv).hold({data, size});
  scene::StiffnessMapOptions colours;
  colours.factor_at_black = model::kSmallestFactor;
  colours.factor_at_white = model::kLargestFactor;
  for (const scene::StiffnessMapOptions& options : {scene::StiffnessMapOptions{}, colours}) {
    fuzz::read_or_refuse(file.string(), [&] {
      for (const model::StiffnessPoint& one : scene::read_stiffness_map(file, options).points) {
        fuzz::require(one.point_S.allFinite(), "a point is finite");
        fuzz::require(one.factor >= model::kSmallestFactor && one.factor <= model::kLargestFactor,
                      "a factor is within its limits");
      }
    });
  }
  return 0;
}
