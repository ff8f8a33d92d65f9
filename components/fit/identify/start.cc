#include "fit/identify/start.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Dense>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"

#include "fit/identify/least_squares.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kMostRows = 300;        // compared; more are averaged
constexpr std::size_t kFewestRows = 8;        // compared
constexpr std::size_t kFirstRows = 3;         // whose mean limits the reading at the first row
constexpr std::size_t kLeadRows = 5;          // before a kink
constexpr std::size_t kRowsBeyond = 4;        // beyond a kink
constexpr double kSmallestStartNoise = 1e-4;  // of the force range: no law follows a curve more closely
constexpr int kBasis = 6;
constexpr int kCurve = 5;  // the column of a lead's curvature

/// The first rows, sorted by displacement.
struct StartRows {
  std::vector<double> place;  // 0 at the first row, 1 at the last
  std::vector<double> force;  // N above the first row
  double length = 0.0;        // m, from the first row to the last
  double averaged = 1.0;      // number of rows behind each point
};

/// A linear least-squares fit of some columns.
struct LineFit {
  double squares = std::numeric_limits<double>::infinity();  // N^2, left
  double unknowns = 0.0;                                     // the place of the kink included
  std::vector<int> columns;
  Eigen::VectorXd values;
  Eigen::VectorXd errors;  // standard errors of the values for noise of 1 N
  double kink = 0.0;       // as a place; 0: none
  std::size_t rows = 0;    // before the kink

  [[nodiscard]] double value(int column) const {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i] == column) return values[static_cast<Eigen::Index>(i)];
    return 0.0;
  }
  /// Force [N] at a place.
  [[nodiscard]] double force_at(double place) const;
  /// Bayes's criterion for noise of this variance [N^2].
  [[nodiscard]] double criterion(double variance, std::size_t points) const {
    return squares / variance + unknowns * portable::log(static_cast<double>(points));
  }
};

/// The columns of a row: 1, u, v, v^2, v^3, u^2 with v = max(0, u - kink); without a kink 1, u, u^2, u^3,
/// u^4.
using Basis = Eigen::Matrix<double, kBasis, 1>;

Basis basis_at(double u, double kink) {
  Basis columns;
  if (kink > 0.0) {
    const double v = std::max(0.0, u - kink);
    columns << 1.0, u, v, v * v, v * v * v, u * u;
  } else {
    columns << 1.0, u, u * u, u * u * u, u * u * u * u, 0.0;
  }
  return columns;
}

double LineFit::force_at(double place) const {
  const Basis row = basis_at(place, kink);
  double force = 0.0;
  for (int column = 0; column < kBasis; ++column) force += row[column] * value(column);
  return force;
}

/// The least-squares fit of some columns; without result where the rows do not determine them.
LineFit fit_columns(const StartRows& rows, double kink, std::vector<int> columns) {
  const auto points = static_cast<Eigen::Index>(rows.place.size());
  const auto size = static_cast<Eigen::Index>(columns.size());
  const Eigen::Map<const Eigen::VectorXd> force(rows.force.data(), points);
  Eigen::MatrixXd matrix(points, size);
  for (Eigen::Index i = 0; i < points; ++i) {
    matrix.row(i) = basis_at(rows.place[static_cast<std::size_t>(i)], kink)(columns);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  LineFit found;
  if (qr.rank() < size) return found;
  const Eigen::MatrixXd inverse =
      qr.matrixR().topRows(size).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(size, size));
  found.unknowns = static_cast<double>(size);
  found.columns = std::move(columns);
  found.values = qr.solve(force);
  found.errors = (qr.colsPermutation() * inverse).rowwise().norm();
  found.squares = (matrix * found.values - force).squaredNorm();
  return found;
}

/// All smooth curves, of degree 1 to 4.
std::vector<LineFit> smooth_fits(const StartRows& rows) {
  std::vector<LineFit> all;
  for (const std::vector<int>& columns : {std::vector<int>{0, 1}, {0, 1, 2}, {0, 1, 2, 3}, {0, 1, 2, 3, 4}}) {
    all.push_back(fit_columns(rows, 0.0, columns));
  }
  return all;
}

/// All curves with a kink: a constant, straight or parabolic lead, and beyond it a polynomial of degree 1
/// to 3.
std::vector<LineFit> kinked_fits(const StartRows& rows) {
  std::vector<LineFit> all;
  const std::size_t count = rows.place.size();
  for (std::size_t last = kLeadRows - 1; last + kRowsBeyond < count; ++last) {
    const double kink = rows.place[last];
    if (!(kink > 0.0) || rows.place[last + 1] == kink) continue;
    for (const std::vector<int>& columns : {std::vector<int>{0, 2},
                                            {0, 2, 3},
                                            {0, 2, 3, 4},
                                            {0, 1, 2},
                                            {0, 1, 2, 3},
                                            {0, 1, 2, 3, 4},
                                            {0, 1, kCurve, 2},
                                            {0, 1, kCurve, 2, 3},
                                            {0, 1, kCurve, 2, 3, 4}}) {
      LineFit& fit = all.emplace_back(fit_columns(rows, kink, columns));
      fit.unknowns += 1.0;
      fit.kink = kink;
      fit.rows = last + 1;
    }
  }
  return all;
}

/// The fit with the lowest criterion.
LineFit best_of(const std::vector<LineFit>& all, double variance, std::size_t points) {
  LineFit best;
  double lowest = std::numeric_limits<double>::infinity();
  for (const LineFit& fit : all) {
    const double criterion = fit.criterion(variance, points);
    if (!(criterion < lowest)) continue;
    lowest = criterion;
    best = fit;
  }
  return best;
}

/// The rows of a curve, sorted by displacement, up to a force [N] above the first rows.
StartRows rows_below(const Specimen& sorted, double rise) {
  std::vector<double> first(sorted.force.begin(), sorted.force.begin() + kLeadRows);
  const double level = median(std::move(first));
  std::size_t count = sorted.size();
  while (count > kFewestRows && sorted.force[count - 1] > level + rise) --count;
  while (!(sorted.displacement[count - 1] > sorted.displacement.front())) ++count;
  Specimen few;
  few.displacement.assign(sorted.displacement.begin(),
                          sorted.displacement.begin() + static_cast<std::ptrdiff_t>(count));
  few.force.assign(sorted.force.begin(), sorted.force.begin() + static_cast<std::ptrdiff_t>(count));
  few = thinned(few, kMostRows);
  StartRows rows;
  rows.length = few.displacement.back() - few.displacement.front();
  rows.averaged = static_cast<double>(count) / static_cast<double>(few.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    rows.place.push_back((few.displacement[i] - few.displacement.front()) / rows.length);
    rows.force.push_back(few.force[i] - sorted.force.front());
  }
  return rows;
}

/// Standard deviation of the noise [N]: normalised median absolute deviation of the second or the fourth
/// differences, whichever is smaller. The fourth ones are blind to a curvature that few rows cannot resolve.
double noise_in(const std::vector<double>& force) {
  std::vector<double> second;
  std::vector<double> fourth;
  for (std::size_t i = 2; i + 2 < force.size(); ++i) {
    second.push_back((force[i - 1] - 2.0 * force[i] + force[i + 1]) / std::sqrt(6.0));
    fourth.push_back(
        (force[i - 2] - 4.0 * force[i - 1] + 6.0 * force[i] - 4.0 * force[i + 1] + force[i + 2]) /
        std::sqrt(70.0));
  }
  return std::min(normalized_mad(std::move(second)), normalized_mad(std::move(fourth)));
}

/// The models of one window.
struct StartWindow {
  StartRows rows;
  LineFit smooth;
  LineFit kinked;
  double variance = 0.0;  // N^2, of the noise
  bool adequate = false;  // one of the models leaves no more than the noise
};

/// @param noise, smallest standard deviation [N] of a row's noise, and its lower limit
StartWindow window_of(const Specimen& sorted, double rise, double noise, double smallest) {
  constexpr double kAdequate = 1.7;  // of the variance of the noise
  StartWindow window;
  window.rows = rows_below(sorted, rise);
  const double expected = std::max(noise * noise / window.rows.averaged, smallest * smallest);
  const std::size_t points = window.rows.place.size();
  const std::vector<LineFit> smooth = smooth_fits(window.rows);
  const std::vector<LineFit> kinked = kinked_fits(window.rows);
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<LineFit>* fits : {&smooth, &kinked}) {
    for (const LineFit& fit : *fits) {
      const double freedom = static_cast<double>(points) - fit.unknowns;
      if (freedom >= 1.0) least = std::min(least, fit.squares / freedom);
    }
  }
  window.variance = std::max(expected, least);
  window.adequate = window.variance < kAdequate * expected;
  std::vector<LineFit> rising;
  std::copy_if(smooth.begin(), smooth.end(), std::back_inserter(rising),
               [](const LineFit& fit) { return fit.value(1) >= 0.0; });
  window.smooth = best_of(rising.empty() ? smooth : rising, window.variance, points);
  window.kinked = best_of(kinked, window.variance, points);
  return window;
}

/// Standard error of a fit's value of a column.
double error_of(const LineFit& fit, int column, double variance) {
  for (std::size_t i = 0; i < fit.columns.size(); ++i)
    if (fit.columns[i] == column) return std::sqrt(variance) * fit.errors[static_cast<Eigen::Index>(i)];
  return 0.0;
}

/// Whether the window's curve has a kink: the steeper curve beyond it is no noise, and no smooth curve does
/// as well.
bool has_kink(const StartWindow& window) {
  constexpr double kSteeper = 0.3;  // of the slope before the kink
  const LineFit& fit = window.kinked;
  const std::size_t points = window.rows.place.size();
  if (!window.adequate || !std::isfinite(fit.squares)) return false;
  if (!(fit.criterion(window.variance, points) < window.smooth.criterion(window.variance, points) - kCertain))
    return false;
  const double jump = fit.value(2);
  return jump > kStartErrors * error_of(fit, 2, window.variance) &&
         jump > kSteeper * (fit.value(1) + 2.0 * fit.value(kCurve) * fit.kink);
}

/// Way [m] from a place to where the fit rises by two standard errors of the force there.
double way_to_rise(const StartWindow& window, const LineFit& fit, double from, double error) {
  constexpr int kSteps = 1000;
  const double level = fit.force_at(from) + 2.0 * error;
  for (int i = 1; i <= kSteps; ++i) {
    const double way = static_cast<double>(i) / kSteps;
    const double lead =  // the baseline goes on
        from > 0.0 ? (fit.value(1) + fit.value(kCurve) * (2.0 * from + way)) * way : 0.0;
    if (fit.force_at(from + way) > level + lead) return way * window.rows.length;
  }
  return window.rows.length;
}

double square(double value) { return value * value; }

void use_kink(const StartWindow& window, const Specimen& sorted, Start& start) {
  constexpr double kCurveError = 13.4;  // sqrt(180): a parabola through rows at equal distances
  constexpr double kCurveErrors = 3.0;  // standard errors
  const LineFit& fit = window.kinked;
  start.kink = sorted.displacement.front() + fit.kink * window.rows.length;
  start.lead_rows = static_cast<std::size_t>(std::count_if(
      sorted.displacement.begin(), sorted.displacement.end(), [&](double d) { return d <= start.kink; }));
  const double length = window.rows.length;
  const auto rows = static_cast<double>(fit.rows);
  start.curve_error = kCurveError * std::sqrt(window.variance / rows) / square(fit.kink * length);
  const double curve = fit.value(kCurve) / square(length);
  const bool curved = std::abs(curve) > kCurveErrors * start.curve_error;
  if (curved) start.lead_curve = curve;
  const bool sloped = curved || std::abs(fit.value(1)) > kStartErrors * error_of(fit, 1, window.variance);
  const double straight = sloped ? 2.0 : 1.0;  // the end of a line is known less well than a mean
  start.lead_force = sloped ? fit.force_at(fit.kink) + sorted.force.front()
                            : mean(std::span(sorted.force).first(start.lead_rows));
  start.lead_slope = sloped ? (fit.value(1) + 2.0 * fit.value(kCurve) * fit.kink) / length : 0.0;
  start.lead_error = straight * std::sqrt(window.variance / rows);
  start.kink_error = way_to_rise(window, fit, fit.kink, start.lead_error);
}

void use_smooth(const StartWindow& window, const Specimen& sorted, Start& start) {
  const LineFit& fit = window.smooth;
  const double level = fit.value(0) + sorted.force.front();
  start.force_error = error_of(fit, 0, window.variance);
  start.contact_error = way_to_rise(window, fit, 0.0, start.force_error);
  // The end of a polynomial may miss the data: the first rows' mean, which a rising force makes larger,
  // limits it, and below zero only what these rows read counts.
  const double rows = mean(std::span(sorted.force).first(kFirstRows));
  start.force = level < 0.0 ? std::min(0.0, std::max(level, rows)) : std::min(level, rows);
  if (start.force != level) {
    start.force_error = std::max(start.force_error, start.noise / std::sqrt(static_cast<double>(kFirstRows)));
  }
  start.slope = fit.value(1) / window.rows.length;
  start.slope_error = error_of(fit, 1, window.variance) / window.rows.length;
}

/// The rows without single ones that are far from the median of their neighbours.
Specimen without_outliers(const Specimen& sorted, double limit) {
  Specimen kept = sorted;
  kept.displacement.clear();
  kept.force.clear();
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool inside = i >= 2 && i + 2 < sorted.size();
    if (inside) {
      const auto around = sorted.force.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::abs(*around - median(std::vector<double>(around - 2, around + 3))) > limit) continue;
    }
    kept.displacement.push_back(sorted.displacement[i]);
    kept.force.push_back(sorted.force[i]);
  }
  return kept;
}

}  // namespace

Start start_of(const Specimen& loading, const Ranges& ranges) {
  constexpr double kFarOff = 8.0;            // standard deviations
  constexpr double kFewestForOutliers = 20;  // rows: fewer may be steep from one to the next
  Specimen sorted = by_displacement(loading);
  const double noise = noise_in(sorted.force);
  if (static_cast<double>(sorted.size()) >= kFewestForOutliers) {
    sorted = without_outliers(sorted, std::max(kFarOff * noise, 0.02 * ranges.force));
  }
  Start start;
  start.noise = std::max(noise, kSmallestStartNoise * ranges.force);
  for (double rise = 0.2 * ranges.force / 16.0; rise < 0.21 * ranges.force; rise *= 2.0) {
    const StartWindow window =
        window_of(sorted, std::max(rise, 4.0 * noise), noise, kSmallestStartNoise * ranges.force);
    if (start.contact_error == 0.0 || window.adequate) use_smooth(window, sorted, start);
    if (start.lead_rows == 0 && has_kink(window)) use_kink(window, sorted, start);
  }
  return start;
}

}  // namespace palpate::identify
