#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "palpate/identify.h"

#include "fit/identify/least_squares.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

constexpr std::size_t kSearched = 2000;   // points: enough for two unknowns
constexpr double kSmallestSpread = 1e-5;  // of the force range

/// Constants of the search.
struct Search {
  identify::Specimen specimen;
  Law law;
  identify::Ranges ranges;
  identify::OwnPrior prior;
  double loss_scale = std::numeric_limits<double>::infinity();
  double sigma = 0.01;  // of the residuals
};

/// Computed minus measured force at each point, divided by the force range.
std::vector<double> plain_residuals(const Search& search, std::span<const double> own) {
  const identify::Specimen& specimen = search.specimen;
  std::vector<double> depths;
  for (const double displacement : specimen.displacement) {
    depths.push_back(displacement - own[0] * search.ranges.displacement);
  }
  std::size_t beyond = 0;
  std::vector<double> values = search.law.forces_at(depths, beyond);
  if (!search.law.tissue.relaxation.empty() && specimen.time.size() > 1) {
    identify::relax(search.law.tissue.relaxation, specimen.time, values);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = (std::max(0.0, values[i]) - specimen.force[i]) / search.ranges.force + own[1];
  }
  return values;
}

/// Residuals after the loss, then those of the priors of the two zeros.
void zero_errors(const Search& search, std::span<const double> own, std::span<double> errors) {
  const std::vector<double> values = plain_residuals(search, own);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = values[i] / search.loss_scale;  // 0 without a loss
    errors[i] = share == 0.0
                    ? values[i]
                    : std::copysign(search.loss_scale * std::sqrt(portable::log1p(share * share)), values[i]);
  }
  const identify::OwnPrior& prior = search.prior;
  errors[values.size()] = search.sigma * (own[0] - prior.first_contact) / prior.first_contact_spread;
  errors[values.size() + 1] = search.sigma * (own[1] - prior.offset) / prior.offset_spread;
}

/// Descends from `own`. @return half the remaining sum of squares
double descend_to_zeros(const Search& search, identify::Point& own) {
  const identify::Bounds bounds = identify::own_bounds(search.prior);
  for (std::size_t i = 0; i < identify::kOwnParameters; ++i)
    own[i] = std::clamp(own[i], bounds.low[i], bounds.high[i]);
  identify::RecordsProblem problem{bounds, {{}}, {search.specimen.size() + identify::kOwnParameters}, {}};
  problem.errors = [&search](std::size_t, std::span<const double> at, std::span<const double>,
                             std::span<double> out) {
    zero_errors(search, at, out);
    return true;
  };
  std::vector<identify::Point> none;
  return 0.5 * identify::minimise(problem, own, none, 60);
}

/// The best of descents from several first contacts across the bounds, and from `own`.
void search_from_everywhere(const Search& search, identify::Point& own) {
  const identify::Bounds bounds = identify::own_bounds(search.prior);
  double best_cost = descend_to_zeros(search, own);
  for (const double way : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    identify::Point start = {bounds.low[0] + way * (bounds.high[0] - bounds.low[0]), search.prior.offset};
    const double cost = descend_to_zeros(search, start);
    if (cost < best_cost) {
      best_cost = cost;
      own = start;
    }
  }
}

/// Spread of the residuals by their median absolute deviation.
double spread_of(const Search& search, const identify::Point& own) {
  return std::max(normalized_mad(plain_residuals(search, own)), kSmallestSpread);
}

}  // namespace

ZerosFit fit_zeros(const identify::Specimen& specimen, const Law& law) {
  constexpr int kMaxRounds = 10;
  constexpr double kSame = 0.8;
  Search search;
  search.specimen = identify::thinned(specimen, kSearched);
  search.law = law;
  search.ranges = identify::ranges_of(search.specimen);
  search.prior = identify::own_prior(search.ranges);
  identify::Point own = {search.prior.first_contact, search.prior.offset};
  search_from_everywhere(search, own);
  // Many outliers widen the loss, which should exclude them: each round narrows it.
  for (int round = 0; round < kMaxRounds; ++round) {
    const double before = search.loss_scale;
    search.sigma = spread_of(search, own);
    search.loss_scale = identify::kLoss * search.sigma;
    if (search.loss_scale > kSame * before) break;
    search_from_everywhere(search, own);
  }
  const identify::Bounds bounds = identify::own_bounds(search.prior);
  ZerosFit fit;
  fit.zeros = {own[0] * search.ranges.displacement, own[1] * search.ranges.force};
  for (std::size_t i = 0; i < identify::kOwnParameters; ++i) {
    const double margin = 1e-6 * (bounds.high[i] - bounds.low[i]);
    fit.at_limit = fit.at_limit || own[i] < bounds.low[i] + margin || own[i] > bounds.high[i] - margin;
  }
  return fit;
}

}  // namespace palpate::validate
