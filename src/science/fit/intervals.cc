#include "science/fit/intervals.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/base/statistics.h"
#include "science/fit/distributions.h"

namespace palpate::fit {
namespace {

std::vector<double> values_at(const Point& point, const Ranges& ranges, std::size_t terms) {
  const std::span<const double> all(point);
  return values_of(all.first(shared_count(terms)), all.subspan(shared_count(terms)), ranges);
}

}  // namespace

std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges,
                                   std::size_t terms) {
  const std::size_t count = shared_count(terms) + kOwnParameters;
  std::vector<std::vector<double>> columns(count);
  for (const Point& point : points) {
    const std::vector<double> values = values_at(point, ranges, terms);
    for (std::size_t i = 0; i < count; ++i) columns[i].push_back(values[i]);
  }
  std::vector<Interval> intervals;
  for (const std::vector<double>& column : columns) {
    intervals.push_back({quantile(column, 0.025), quantile(column, 0.975)});
  }
  return intervals;
}

std::vector<Point> nearly_best(const Ensemble& ensemble, double effective) {
  // a cloud of points never holds the very best for every value of one parameter: that much less likely they
  // are
  constexpr double kCloud = 0.3;
  const double t = student(effective - static_cast<double>(ensemble.points.front().size()));
  const double limit =
      *std::max_element(ensemble.log_posterior.begin(), ensemble.log_posterior.end()) - 0.5 * t * t - kCloud;
  std::vector<Point> points;
  for (std::size_t i = 0; i < ensemble.points.size(); ++i) {
    if (ensemble.log_posterior[i] >= limit) points.push_back(ensemble.points[i]);
  }
  return points;
}

std::vector<std::optional<Interval>> covariance_intervals(const Minima& minima) {
  const Problem& problem = minima.problem;
  const Part& part = problem.parts.front();
  const Solution& best = minima.all.front();
  const std::vector<double> derivatives = jacobian(problem, part, best.shared, best.own.front());
  const auto rows = static_cast<Eigen::Index>(residual_count(part));
  const auto columns = static_cast<Eigen::Index>(best.shared.size() + kOwnParameters);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd j = Eigen::Map<const RowMajor>(derivatives.data(), rows, columns);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinV);
  const Eigen::VectorXd& singular = svd.singularValues();
  const double inflate = static_cast<double>(part.specimen->size()) / std::max(1.0, minima.effective);
  const double t = student(minima.effective - static_cast<double>(columns));
  std::vector<std::optional<Interval>> intervals;
  for (Eigen::Index c = 0; c < columns; ++c) {
    constexpr double kFlat = 1e-10;  // of the largest singular value
    double variance = 0.0;
    bool flat = false;
    for (Eigen::Index k = 0; k < singular.size(); ++k) {
      const double along = svd.matrixV()(c, k);
      if (singular[k] <= kFlat * singular[0]) {
        flat = flat || std::abs(along) > 1e-3;
      } else {
        variance += along * along / (singular[k] * singular[k]);
      }
    }
    const double reach = t * problem.sigma * std::sqrt(inflate * variance);
    if (flat || !(reach < 50.0)) {
      intervals.emplace_back(std::nullopt);
      continue;
    }
    Point point = best.shared;
    point.insert(point.end(), best.own.front().begin(), best.own.front().end());
    const auto index = static_cast<std::size_t>(c);
    const double centre = point[index];
    point[index] = centre - reach;
    const double low = values_at(point, part.ranges, problem.terms)[index];
    point[index] = centre + reach;
    const double high = values_at(point, part.ranges, problem.terms)[index];
    intervals.emplace_back(Interval{std::min(low, high), std::max(low, high)});
  }
  return intervals;
}

std::vector<std::vector<double>> correlations(const std::vector<Point>& points) {
  const std::size_t count = points.front().size();
  std::vector<std::vector<double>> columns(count);
  for (const Point& point : points) {
    for (std::size_t i = 0; i < count; ++i) columns[i].push_back(point[i]);
  }
  std::vector<std::vector<double>> all(count, std::vector<double>(count, 0.0));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < count; ++k) all[i][k] = correlation(columns[i], columns[k]);
  }
  return all;
}

}  // namespace palpate::fit
