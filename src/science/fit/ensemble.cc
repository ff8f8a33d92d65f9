#include "science/fit/ensemble.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "palpate/fit.h"
#include "science/fit/random.h"

namespace palpate::fit {
namespace {

constexpr std::uint32_t kEnsembleStream = 1;  // of a specimen's job
constexpr int kGenerations = 1500;            // of one round
constexpr int kMostRounds = 4;                // the first is thrown away; more when halves differ
constexpr int kKeepEvery = 4;

/// ln of the posterior, up to a constant.
class Posterior final {
 public:
  Posterior(const Problem& problem, double effective)
      : problem_(problem),
        part_(problem.parts.front()),
        own_bounds_(fit::own_bounds(part_.prior)),
        effective_(effective),
        values_(residual_count(part_)) {}

  [[nodiscard]] double at(const Point& point) {
    const std::size_t shared = problem_.bounds.low.size();
    for (std::size_t i = 0; i < point.size(); ++i) {
      const double low = i < shared ? problem_.bounds.low[i] : own_bounds_.low[i - shared];
      const double high = i < shared ? problem_.bounds.high[i] : own_bounds_.high[i - shared];
      if (!(point[i] >= low && point[i] <= high)) return kNever;
    }
    const std::span<const double> all(point);
    residuals(problem_, part_, all.first(shared), all.subspan(shared), values_);
    const std::size_t points = part_.specimen->size();
    double squares = static_cast<double>(points) * kSmallestSigma * kSmallestSigma;
    for (std::size_t i = 0; i < points; ++i) squares += values_[i] * values_[i];
    double prior = 0.0;
    for (std::size_t i = points; i < values_.size(); ++i) prior += values_[i] * values_[i];
    prior /= problem_.sigma * problem_.sigma;
    const double result = -0.5 * effective_ * portable::log(squares) - 0.5 * prior;
    return std::isfinite(result) ? result : kNever;
  }

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  const Problem& problem_;
  const Part& part_;
  Bounds own_bounds_;
  double effective_;
  std::vector<double> values_;
};

struct Walker {
  Point point;
  double log_posterior = 0.0;
};

Point joined(const Solution& solution) {
  Point point = solution.shared;
  point.insert(point.end(), solution.own.front().begin(), solution.own.front().end());
  return point;
}

/// Directions in which the data leave room at a minimum, each as long as its standard deviation (at most 1):
/// the columns of a matrix.
Eigen::MatrixXd room_at(const Problem& problem, const Solution& minimum) {
  constexpr double kMost = 1.0;  // of a logarithm: beyond, a straight line is no guide
  const Part& part = problem.parts.front();
  const std::vector<double> derivatives = jacobian(problem, part, minimum.shared, minimum.own.front());
  const auto columns = static_cast<Eigen::Index>(minimum.shared.size() + kOwnParameters);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd j = Eigen::Map<const RowMajor>(
      derivatives.data(), static_cast<Eigen::Index>(residual_count(part)), columns);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinV);
  Eigen::MatrixXd room = svd.matrixV();
  for (Eigen::Index k = 0; k < columns; ++k) {
    const double singular = svd.singularValues()[k];
    room.col(k) *= singular * kMost > problem.sigma ? problem.sigma / singular : kMost;
  }
  return room;
}

/// Walkers around the minima that the data do not rule out, most of them around the best, spread as far as
/// the data leave room.
std::vector<Walker> first_walkers(Posterior& posterior, const Problem& problem,
                                  const std::vector<Solution>& minima, std::size_t count, Random& random) {
  constexpr double kRuledOut = 3.0;  // ln of a ratio of probabilities; walkers seldom leave a minimum again
  constexpr double kFar = 24.0;
  const double best = posterior.at(joined(minima.front()));
  std::vector<Point> centres;
  std::vector<Eigen::MatrixXd> rooms;
  for (const Solution& minimum : minima) {
    const Point centre = joined(minimum);
    if (!centres.empty() && !(posterior.at(centre) > best - kRuledOut)) continue;
    centres.push_back(centre);
    rooms.push_back(room_at(problem, minimum));
  }
  std::vector<Walker> walkers;
  for (std::size_t w = 0; w < count; ++w) {
    const std::size_t chosen = w % 2 == 0 ? 0 : (w / 2) % centres.size();
    const Point& centre = centres[chosen];
    Walker walker;
    double spread = 2.0;
    do {  // far out at first, nearer and nearer until it is somewhere the data do not rule out
      walker.point = centre;
      for (Eigen::Index k = 0; k < rooms[chosen].cols(); ++k) {
        const double way = spread * random.normal();
        for (std::size_t i = 0; i < centre.size(); ++i) {
          walker.point[i] += way * rooms[chosen](static_cast<Eigen::Index>(i), k);
        }
      }
      walker.log_posterior = posterior.at(walker.point);
      spread *= 0.85;
    } while (!(walker.log_posterior > best - kFar) && spread > 1e-9);
    if (!std::isfinite(walker.log_posterior)) {
      walker.point = centre;
      walker.log_posterior = posterior.at(centre);
    }
    walkers.push_back(std::move(walker));
  }
  return walkers;
}

/// One step of every walker in turn.
void step_all(Posterior& posterior, std::vector<Walker>& walkers, bool whole_steps, Random& random) {
  const std::size_t dimensions = walkers.front().point.size();
  const double usual = 2.38 / std::sqrt(2.0 * static_cast<double>(dimensions));
  for (std::size_t w = 0; w < walkers.size(); ++w) {
    std::size_t a = random.below(walkers.size() - 1);
    std::size_t b = random.below(walkers.size() - 2);
    if (b >= a) ++b;  // two different ones of the others
    if (a >= w) ++a;
    if (b >= w) ++b;
    const double gamma = whole_steps ? 1.0 : usual * (0.5 + random.uniform());
    Walker tried;
    tried.point = walkers[w].point;
    for (std::size_t i = 0; i < dimensions; ++i) {
      const double way = walkers[a].point[i] - walkers[b].point[i];
      // a little of its own for every direction, or walkers would stay in the space that they began in
      tried.point[i] += gamma * way + 0.01 * way * random.normal() + 1e-9 * random.normal();
    }
    tried.log_posterior = posterior.at(tried.point);
    const double rise = tried.log_posterior - walkers[w].log_posterior;
    if (rise >= 0.0 || portable::log(random.uniform()) < rise) walkers[w] = std::move(tried);
  }
}

/// Ends of the 95 % interval of one parameter.
Interval interval_of(std::span<const Point> points, std::size_t parameter) {
  std::vector<double> values;
  for (const Point& point : points) values.push_back(point[parameter]);
  return {quantile(values, 0.025), quantile(values, 0.975)};
}

/// Whether the ends of the 95 % interval of every parameter are the same in both halves to a fifth of its
/// width.
bool halves_agree(const std::vector<Point>& points) {
  constexpr double kPart = 0.2;
  const std::span<const Point> all(points);
  const std::size_t middle = points.size() / 2;
  for (std::size_t i = 0; i < points.front().size(); ++i) {
    const Interval first = interval_of(all.first(middle), i);
    const Interval second = interval_of(all.subspan(middle), i);
    const double most = kPart * (std::max(first.high, second.high) - std::min(first.low, second.low));
    if (std::abs(first.low - second.low) > most || std::abs(first.high - second.high) > most) return false;
  }
  return true;
}

}  // namespace

double log_posterior_of(const Problem& problem, const Point& point, double effective) {
  return Posterior(problem, effective).at(point);
}

Ensemble draw_ensemble(const Problem& problem, const std::vector<Solution>& minima, double effective,
                       std::uint64_t seed, std::uint32_t job, const std::function<void(double)>& progress) {
  Random random(seed, job, kEnsembleStream);
  Posterior posterior(problem, effective);
  const std::size_t dimensions = problem.bounds.low.size() + kOwnParameters;
  std::vector<Walker> walkers = first_walkers(posterior, problem, minima, 6 * dimensions, random);
  Ensemble ensemble;
  for (int round = 0; round < kMostRounds && !ensemble.settled; ++round) {
    ensemble.points.clear();  // the rounds before were the way there
    ensemble.log_posterior.clear();
    for (int generation = 0; generation < kGenerations; ++generation) {
      constexpr int kWholeStepEvery = 10;
      step_all(posterior, walkers, generation % kWholeStepEvery == 0, random);
      if (generation % kKeepEvery == 0) {
        for (const Walker& walker : walkers) {
          ensemble.points.push_back(walker.point);
          ensemble.log_posterior.push_back(walker.log_posterior);
        }
        if (progress) progress((round + static_cast<double>(generation) / kGenerations) / 2.0);
      }
    }
    ensemble.settled = round > 0 && halves_agree(ensemble.points);
  }
  return ensemble;
}

}  // namespace palpate::fit
