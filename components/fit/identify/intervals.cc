#include "fit/identify/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <boost/math/distributions/students_t.hpp>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"

#include "fit/identify/profile_path.h"

namespace palpate::identify {
namespace {

Point joined(const Solution& solution) {
  Point point = solution.shared;
  point.insert(point.end(), solution.own.front().begin(), solution.own.front().end());
  return point;
}

/// Whether the others have both smaller and larger values of every parameter.
bool enclosed(const Point& point, const std::vector<Point>& others) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    const auto less = [&](const Point& other) { return other[i] < point[i]; };
    const auto more = [&](const Point& other) { return other[i] > point[i]; };
    if (std::none_of(others.begin(), others.end(), less) ||
        std::none_of(others.begin(), others.end(), more)) {
      return false;
    }
  }
  return true;
}

std::vector<double> values_at(const Point& point, const Ranges& ranges, std::size_t terms) {
  const std::span<const double> all(point);
  return values_of(all.first(shared_count(terms)), all.subspan(shared_count(terms)), ranges);
}

}  // namespace

std::vector<Interval> intervals_of(const std::vector<Point>& points, const Ranges& ranges, std::size_t terms,
                                   double share) {
  const std::size_t count = shared_count(terms) + kOwnParameters;
  std::vector<std::vector<double>> columns(count);
  for (const Point& point : points) {
    const std::vector<double> values = values_at(point, ranges, terms);
    for (std::size_t i = 0; i < count; ++i) columns[i].push_back(values[i]);
  }
  std::vector<Interval> intervals;
  for (const std::vector<double>& column : columns) {
    intervals.push_back({quantile(column, 0.5 - 0.5 * share), quantile(column, 0.5 + 0.5 * share)});
  }
  return intervals;
}

double log_posterior_of(const Problem& problem, const Solution& at, double effective) {
  const Part& part = problem.parts.front();
  std::vector<double> values(residual_count(part));
  residuals(problem, part, at.shared, at.own.front(), values);
  const std::size_t points = part.specimen->size();
  double squares = static_cast<double>(points) * kSmallestSigma * kSmallestSigma;
  for (std::size_t i = 0; i < points; ++i) squares += values[i] * values[i];
  double prior = 0.0;
  for (std::size_t i = points; i < values.size(); ++i) prior += values[i] * values[i];
  prior /= problem.sigma * problem.sigma;
  const double result = -0.5 * effective * portable::log(squares) - 0.5 * prior;
  return std::isfinite(result) ? result : -std::numeric_limits<double>::infinity();
}

double likelihood_limit(double effective, std::size_t parameters) {
  // Widens the test for laws with several local optima, which a test at one of them does not cover. With 1,
  // in some rows of tools/update_accuracy 88 of 100 intervals contain the true value.
  constexpr double kWider = 1.2;
  return kWider * student_t_quantile(effective - static_cast<double>(parameters));
}

std::vector<Point> profile_points(const LocalOptima& optima, double effective,
                                  const std::function<void(double)>& progress) {
  const Problem& problem = optima.problem;
  const std::size_t parameters = problem.bounds.low.size() + kOwnParameters;
  const double best = log_posterior_of(problem, optima.all.front(), effective);
  const double t = likelihood_limit(effective, parameters);
  // square root of the likelihood ratio, divided by the limit of the test
  const auto ratio = [&](const Solution& at) {
    return std::sqrt(std::max(0.0, 2.0 * (best - log_posterior_of(problem, at, effective)))) / t;
  };
  std::vector<Point> points;
  const auto keep = [&points](const Solution& at) { points.push_back(joined(at)); };
  for (std::size_t m = 0; m < optima.all.size(); ++m) {
    if (progress) progress(static_cast<double>(m) / static_cast<double>(optima.all.size()));
    if (!(ratio(optima.all[m]) <= 1.0) || enclosed(joined(optima.all[m]), points)) continue;
    keep(optima.all[m]);
    for (std::size_t i = 0; i < parameters; ++i) {
      for (const double direction : {-1.0, 1.0})
        follow_profile_path(problem, optima.all[m], i, direction, ratio, keep);
    }
  }
  return points;
}

Curvature curvature_of(const LocalOptima& optima) {
  const Problem& problem = optima.problem;
  const Part& part = problem.parts.front();
  const Solution& best = optima.all.front();
  const std::vector<double> derivatives = jacobian(problem, part, best.shared, best.own.front());
  const auto rows = static_cast<Eigen::Index>(residual_count(part));
  const auto columns = static_cast<Eigen::Index>(best.shared.size() + kOwnParameters);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd j = Eigen::Map<const RowMajor>(derivatives.data(), rows, columns);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinV);
  constexpr double kFlat = 1e-10;  // relative to the largest singular value
  const double smallest = kFlat * svd.singularValues()[0];
  const Eigen::ArrayXd room = svd.singularValues().array().max(smallest).inverse();
  const Eigen::MatrixXd reach = svd.matrixV() * room.matrix().asDiagonal();
  const Eigen::MatrixXd covariance = reach * reach.transpose();
  const double inflate = static_cast<double>(part.specimen->size()) / std::max(1.0, optima.effective);
  const double t = student_t_quantile(optima.effective - static_cast<double>(columns));
  Curvature curvature;
  for (Eigen::Index c = 0; c < columns; ++c) {
    std::vector<double>& row = curvature.correlations.emplace_back();
    for (Eigen::Index k = 0; k < columns; ++k) {
      row.push_back(covariance(c, k) / std::sqrt(covariance(c, c) * covariance(k, k)));
    }
    const double way = t * problem.sigma * std::sqrt(inflate * covariance(c, c));
    if (!(way < 50.0)) {
      curvature.intervals.emplace_back(std::nullopt);
      continue;
    }
    Point point = joined(best);
    const auto index = static_cast<std::size_t>(c);
    const double centre = point[index];
    point[index] = centre - way;
    const double low = values_at(point, part.ranges, problem.terms)[index];
    point[index] = centre + way;
    const double high = values_at(point, part.ranges, problem.terms)[index];
    curvature.intervals.emplace_back(Interval{std::min(low, high), std::max(low, high)});
  }
  return curvature;
}

double student_t_quantile(double freedom) {
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 3.0)), 0.975);
}

}  // namespace palpate::identify
