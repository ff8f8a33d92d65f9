#include "app/validate_against.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "palpate/base/clock.h"
#include "palpate/deform/displacement.h"
#include "palpate/model/layered_law.h"
#include "palpate/model/smooth_law.h"

namespace palpate::app {
namespace {

/// Processor time of one call [ns]: the least of several batches, each long enough for the clock.
template <typename Call>
double call_ns(const Call& call, double largest) {
  constexpr std::int64_t kLongEnough = 2'000'000;  // ns
  constexpr int kBatches = 5;
  double least = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int batch = 0; batch < kBatches; ++batch) {
    std::int64_t spent = 0;
    int calls = 0;
    for (int more = 1; spent < kLongEnough; more *= 2) {
      const std::int64_t begun = thread_cpu_ns();
      for (int i = 0; i < more; ++i) sum += call(largest * (i % 101 + 1) / 101.0);
      spent += thread_cpu_ns() - begun;
      calls += more;
    }
    least = std::min(least, static_cast<double>(spent) / calls);
  }
  volatile double kept = sum;  // so that no call can be left out
  static_cast<void>(kept);
  return least;
}

double law_ns(const fit::Law& law, double deepest) {
  if (law.tissue.law == model::LawKind::kSmooth) {
    const model::SmoothSpringLaw springs(law.tissue, law.direction, law.period);
    return call_ns([&springs](double depth) { return springs.force_at(depth).force; }, deepest);
  }
  const model::LayeredSpringLaw springs(law.tissue, law.direction, law.period);
  return call_ns([&springs](double depth) { return springs.force_at(depth).force; }, deepest);
}

void add(fit::RivalFit fit, double largest, std::vector<report::RivalResult>& rivals) {
  report::RivalResult result;
  result.cost_ns = call_ns(fit.evaluate, largest);
  result.fit = std::move(fit);
  rivals.push_back(std::move(result));
}

}  // namespace

void compare_with(const std::vector<fit::RivalKind>& kinds, const fit::Zeros& zeros,
                  report::Validation& validation) {
  for (report::ForceSet& set : validation.forces) {
    const std::vector<double>& displacement = set.ours.measured.displacement;
    const double deepest = *std::max_element(displacement.begin(), displacement.end()) - zeros.first_contact;
    for (const fit::RivalKind kind : kinds) {
      add(fit::fit_force_rival(kind, set.ours, zeros), deepest, set.rivals);
    }
    set.cost_ns = law_ns(validation.law, deepest);
  }
  for (report::ProfileSet& set : validation.profiles) {
    const double farthest = set.ours.measured.distance.back();
    for (const fit::RivalKind kind : kinds) {
      add(fit::fit_profile_rival(kind, set.ours), farthest, set.rivals);
    }
    const deform::SurfaceProfile profile(validation.law.tissue.reach, set.ours.depth, set.ours.tip_radius,
                                         set.ours.tip_radius);
    set.cost_ns = call_ns([&profile](double r) { return profile.at(r); }, farthest);
  }
}

}  // namespace palpate::app
