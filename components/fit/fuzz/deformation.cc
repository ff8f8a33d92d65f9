// Deformations from CSV. Valid ones can be compared with the model.
#include <cmath>

#include "palpate/validate.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    for (const validate::Deformation& deformation : validate::read_deformations(file)) {
      fuzz::require(deformation.size() >= validate::kFewestPlaces, "a deformation has enough places");
      fuzz::require(deformation.displacement.size() == deformation.size(), "every place has a displacement");
      double last = 0.0;
      for (const double r : deformation.distance) {
        fuzz::require(r >= last, "distances rise from 0");
        last = r;
      }
      const double deep = 1e4;  // m: more than any accepted displacement
      const auto comparison = validate::compare_deformation(deformation, {}, deep, 5e-3);
      fuzz::require(std::isfinite(comparison.errors.rms), "an error is finite");
    }
  });
  return 0;
}
