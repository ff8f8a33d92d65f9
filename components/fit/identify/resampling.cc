#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/random.h"
#include "run/tasks/for_each_task.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/intervals.h"
#include "fit/identify/least_squares.h"

namespace palpate::identify {
namespace {

constexpr std::uint32_t kResamplingStream = 2;  // random stream of a specimen's job
constexpr std::size_t kDescents = 2;            // optima from which each resample is fitted

Solution best_from(const Problem& problem, const std::vector<Solution>& optima) {
  Solution best;
  for (std::size_t m = 0; m < std::min(kDescents, optima.size()); ++m) {
    Solution found = solve(problem, optima[m], 25);
    if (found.cost < best.cost || best.shared.empty()) best = std::move(found);
  }
  return best;
}

}  // namespace

std::vector<Point> bootstrap(const LocalOptima& optima, int count, std::uint64_t seed, std::uint32_t job,
                             const std::function<void(double)>& progress, tasks::Communicator* ranks) {
  const Part& part = optima.problem.parts.front();
  const Specimen& specimen = *part.specimen;
  const Solution& best = optima.all.front();
  std::vector<double> fitted(specimen.size());
  predict(specimen, part.ranges, optima.problem.settings, best.shared, best.own.front(), fitted);
  // a fit of p parameters makes residuals smaller than the noise by this factor
  const auto n = static_cast<double>(specimen.size());
  const auto parameters = static_cast<double>(best.shared.size() + kOwnParameters);
  const double widen = n > parameters ? std::sqrt(n / (n - parameters)) : 1.0;
  const auto block = static_cast<std::size_t>(std::max(1.0, std::ceil(n / optima.effective)));
  const std::size_t draws = (specimen.size() + block - 1) / block;  // per resample
  const auto resample = [&](std::size_t b) {
    Random random(seed, job, kResamplingStream);
    random.skip(b * draws);
    Specimen again = specimen;
    for (std::size_t i = 0; i < specimen.size(); i += block) {
      const std::size_t from = random.below(specimen.size());
      for (std::size_t k = 0; k < block && i + k < specimen.size(); ++k) {
        const std::size_t drawn = (from + k) % specimen.size();
        again.force[i + k] = fitted[i + k] + widen * (specimen.force[drawn] - fitted[drawn]);
      }
    }
    Problem problem = optima.problem;
    problem.parts.front().specimen = &again;
    const Solution found = best_from(problem, optima.all);
    Point point = found.shared;
    point.insert(point.end(), found.own.front().begin(), found.own.front().end());
    return bytes_of(std::span<const double>(point));
  };
  int done = 0;
  const auto arrived = [&](std::size_t) {
    if (progress) progress(static_cast<double>(++done) / count);
  };
  std::vector<Point> points;
  const tasks::Tasks tasks{static_cast<std::size_t>(count), resample, {}, arrived, true};
  for (const std::string& bytes : for_each_task(ranks, tasks).results) points.push_back(doubles_of(bytes));
  return points;
}

double cross_validation_error(const LocalOptima& optima) {
  constexpr std::size_t kFolds = 5;
  const Part& part = optima.problem.parts.front();
  const Specimen& specimen = *part.specimen;
  std::vector<double> force(specimen.size());
  double squares = 0.0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    Problem problem = optima.problem;
    for (std::size_t i = fold; i < specimen.size(); i += kFolds) problem.parts.front().weight[i] = 0.0;
    const Solution found = best_from(problem, optima.all);
    predict(specimen, part.ranges, problem.settings, found.shared, found.own.front(), force);
    for (std::size_t i = fold; i < specimen.size(); i += kFolds) {
      const double miss = (force[i] - specimen.force[i]) / part.ranges.force;
      squares += miss * miss;
    }
  }
  return std::sqrt(squares / static_cast<double>(specimen.size()));
}

}  // namespace palpate::identify
