#include "fit/identify/parts.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kMostUntimedPoints = 1000;  // per specimen, without relaxation
constexpr std::size_t kMostTimedPoints = 2000;    // per specimen, with relaxation, whose fast terms need
                                                  // dense samples
constexpr std::size_t kMostPooledPoints = 400;    // per specimen, in the pooled fit

}  // namespace

Specimen as_fitted(const Specimen& specimen, const Settings& settings) {
  return thinned(specimen, settings.relaxation ? kMostTimedPoints : kMostUntimedPoints);
}

std::vector<Specimen> as_pooled(const std::vector<Specimen>& specimens) {
  std::vector<Specimen> pooled;
  for (const Specimen& specimen : specimens) pooled.push_back(thinned(specimen, kMostPooledPoints));
  return pooled;
}

std::vector<Part> pooled_parts(const std::vector<Specimen>& pooled) {
  constexpr double kWeight = 100.0;  // total weight of a specimen
  std::vector<Part> parts;
  for (const Specimen& specimen : pooled) {
    parts.push_back(make_part(specimen));
    const double equal = kWeight / static_cast<double>(specimen.size());
    for (double& weight : parts.back().weight) weight = equal;
  }
  return parts;
}

}  // namespace palpate::identify
