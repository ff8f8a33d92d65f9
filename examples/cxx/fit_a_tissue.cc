// Fits tissue parameters to measured force over displacement, with 95 % intervals.
// Usage: fit_a_tissue [MEASURED.csv]
// Without a file it fits a synthetic measurement: a known tissue, 60 points to 18 mm, and 2 mN of noise.
#include <iostream>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

namespace {

/// The true parameters of the synthetic measurement.
palpate::model::TissueParameters known_tissue() {
  palpate::model::TissueParameters tissue = palpate::model::tissue_preset("liver");
  tissue.law = palpate::model::LawKind::kSmooth;
  return tissue;
}

palpate::identify::Specimen made_up() {
  const palpate::model::SpringLaw law(known_tissue(), palpate::model::Direction::kPress, 1e-3);
  palpate::identify::Specimen specimen;
  specimen.name = "made up";
  for (int i = 0; i < 60; ++i) {
    const double depth = 18e-3 * i / 59.0;
    const double error = 2e-3 * palpate::noise::unit_sample(7, 0, static_cast<std::uint64_t>(i));
    specimen.displacement.push_back(depth);
    specimen.force.push_back(law.force_at(depth).force + error);
  }
  return specimen;
}

void show(const palpate::identify::SpecimenFit& fit) {
  std::cout << fit.name << ": " << fit.points << " points, rms " << 1e3 * fit.rms << " mN\n";
  const std::vector<palpate::identify::ParameterLabel> labels = palpate::identify::labels(fit.terms);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const palpate::identify::Estimate& estimate = fit.estimates[i];
    const double unit = labels[i].unit;
    std::cout << "  " << labels[i].name << " = " << estimate.value / unit
              << ", 95 %: " << estimate.interval.low / unit << " .. " << estimate.interval.high / unit
              << '\n';
  }
  // The parameters are correlated. The force at a displacement is known much more accurately than any of
  // them.
  const std::size_t middle = fit.curve.displacement.size() / 2;
  std::cout << "  at " << 1e3 * fit.curve.displacement[middle] << " mm: measured "
            << fit.curve.measured[middle] << " N, fitted " << fit.curve.fitted[middle]
            << " N, 95 %: " << fit.curve.low[middle] << " .. " << fit.curve.high[middle] << " N\n";
  for (const std::string& warning : fit.warnings) std::cout << "  note: " << warning << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<palpate::identify::Specimen> specimens =
        argc > 1 ? palpate::identify::read_specimens(argv[1]) : std::vector{made_up()};
    palpate::identify::Settings settings;
    settings.law = palpate::model::LawKind::kSmooth;
    std::vector<palpate::identify::SpecimenFit> fits;
    for (std::size_t i = 0; i < specimens.size(); ++i) {
      fits.push_back(
          palpate::identify::fit_specimen(specimens[i], settings, static_cast<std::uint32_t>(i), {}));
      show(fits.back());
    }
    // One tissue for all specimens. A scene can use it, and palpate::scene::to_toml() makes a tissue file of
    // it.
    const palpate::identify::PooledFit pooled = palpate::identify::fit_pooled(specimens, fits, settings, {});
    std::cout << "tissue of " << pooled.specimens << " specimen(s): k1 = " << pooled.tissue.k1 << " N/m\n";
  } catch (const palpate::InputError& error) {
    std::cerr << "fit_a_tissue: " << error.what() << '\n';
    return 2;
  }
  return 0;
}
