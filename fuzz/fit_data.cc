// Measured curves as CSV; what was read can be thinned and has ranges.
#include <algorithm>
#include <cmath>

#include "palpate/fit.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    for (const fit::Specimen& specimen : fit::read_specimens(file)) {
      fuzz::require(specimen.size() >= fit::kFewestPoints, "a specimen has enough points");
      const fit::Specimen few = fit::thinned(specimen, 7);
      fuzz::require(few.size() <= 7, "a thinned specimen has no more points than asked for");
      for (const double value : few.force) fuzz::require(std::isfinite(value), "forces are finite");
      const fit::Ranges ranges = fit::ranges_of(specimen);
      fuzz::require(ranges.force > 0.0 && ranges.displacement > 0.0, "ranges are above 0");
      const fit::OwnPrior prior = fit::own_prior(ranges);
      fuzz::require(std::isfinite(prior.first_contact) && prior.first_contact_spread > 0.0,
                    "a prior is finite");
      fuzz::require(std::isfinite(fit::flat_until(specimen, ranges)), "the end of the flat part is finite");
    }
  });
  return 0;
}
