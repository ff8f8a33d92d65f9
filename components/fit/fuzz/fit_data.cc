// Measured curves from CSV. Valid ones can be thinned and have ranges.
#include <cmath>

#include "palpate/identify.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    for (const identify::Specimen& specimen : identify::read_specimens(file)) {
      fuzz::require(specimen.size() >= identify::kFewestPoints, "a specimen has enough points");
      const identify::Specimen few = identify::thinned(specimen, 7);
      fuzz::require(few.size() <= 7, "a thinned specimen has no more points than asked for");
      for (const double value : few.force) fuzz::require(std::isfinite(value), "forces are finite");
      const identify::Ranges ranges = identify::ranges_of(specimen);
      fuzz::require(ranges.force > 0.0 && ranges.displacement > 0.0, "ranges are above 0");
      const identify::OwnPrior prior = identify::own_prior(ranges);
      fuzz::require(std::isfinite(prior.first_contact) && prior.first_contact_spread > 0.0,
                    "a prior is finite");
      fuzz::require(std::isfinite(identify::flat_until(specimen, ranges)),
                    "the end of the flat part is finite");
    }
  });
  return 0;
}
