// Stiffness maps from CSV. A map that is read has finite points and factors within their limits.
#include "io/scene/variation_reader.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    for (const model::StiffnessPoint& one : scene::read_stiffness_map(file)) {
      fuzz::require(one.point_S.allFinite(), "a point is finite");
      fuzz::require(one.factor >= model::kSmallestFactor && one.factor <= model::kLargestFactor,
                    "a factor is within its limits");
    }
  });
  return 0;
}
