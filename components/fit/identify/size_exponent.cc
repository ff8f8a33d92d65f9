#include "fit/identify/size_exponent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::identify {
namespace {

constexpr double kLowest = model::kSizeExponentRange.low;
constexpr double kHighest = model::kSizeExponentRange.high;

/// Displacement of a specimen's first contact [m] by its own fit.
double first_contact_of(const SpecimenFit& fit) { return fit.estimates[shared_count(fit.terms)].value; }

/// The depth [m] that every specimen reaches.
double common_depth(const std::vector<Specimen>& specimens, const std::vector<SpecimenFit>& fits) {
  double least = 0.0;
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    const std::vector<double>& displacement = specimens[i].displacement;
    const double depth =
        *std::max_element(displacement.begin(), displacement.end()) - first_contact_of(fits[i]);
    least = i == 0 ? depth : std::min(least, depth);
  }
  return least;
}

/// Mean of ln F of a fit over the deeper half of the way to `depth` [m]: nearer to the surface the
/// uncertainty of first contact counts most.
double log_force(const SpecimenFit& fit, const Settings& settings, double depth) {
  constexpr int kSteps = 8;
  const model::SpringLaw law(tissue_of(fit.shared, settings), settings.direction, settings.period);
  double sum = 0.0;
  for (int i = kSteps / 2; i <= kSteps; ++i) sum += portable::log(law.force_at(depth * i / kSteps).force);
  return sum / (kSteps / 2 + 1);
}

struct Line {
  double slope = 0.0;
  double error = 0.0;  // standard error of the slope; 0 for two points
};

Line line_through(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Line line{xy / xx, 0.0};
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - mean_y - line.slope * (x[i] - mean_x);
    squares += off * off;
  }
  if (x.size() > 2) line.error = std::sqrt(squares / (n - 2.0) / xx);
  return line;
}

/// @throws InputError when some specimens have a radius and others do not
bool have_radii(const std::vector<Specimen>& specimens) {
  const auto has = [](const Specimen& one) { return one.tip_radius > 0.0; };
  const auto without = std::find_if_not(specimens.begin(), specimens.end(), has);
  if (without == specimens.end()) return true;
  if (std::none_of(specimens.begin(), specimens.end(), has)) return false;
  throw InputError(fmt::format(
      "specimen {}: has no indenter_radius_mm, others have one: give it for all or for none", without->name));
}

}  // namespace

double reference_radius(const std::vector<Specimen>& specimens) {
  if (specimens.empty() || !have_radii(specimens)) return 0.0;
  double middle = 0.0;
  for (const Specimen& one : specimens) {
    middle += portable::log(one.tip_radius) / static_cast<double>(specimens.size());
  }
  const auto off = [middle](const Specimen& one) { return std::abs(portable::log(one.tip_radius) - middle); };
  return std::min_element(specimens.begin(), specimens.end(),
                          [&off](const Specimen& a, const Specimen& b) { return off(a) < off(b); })
      ->tip_radius;
}

std::optional<SizeExponent> fit_size_exponent(const std::vector<Specimen>& specimens,
                                              const std::vector<SpecimenFit>& fits,
                                              const Settings& settings) {
  if (!have_radii(specimens)) return std::nullopt;
  const auto [small, large] =
      std::minmax_element(specimens.begin(), specimens.end(),
                          [](const Specimen& a, const Specimen& b) { return a.tip_radius < b.tip_radius; });
  if (!(large->tip_radius > kClearlyDifferent * small->tip_radius)) return std::nullopt;
  const double depth = common_depth(specimens, fits);
  if (!(depth > 0.0)) throw InputError("size exponent: no depth is common to all specimens");
  std::vector<double> radii;
  std::vector<double> forces;
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    radii.push_back(portable::log(specimens[i].tip_radius));
    forces.push_back(log_force(fits[i], settings, depth));
  }
  const Line line = line_through(radii, forces);
  SizeExponent size;
  size.reference_radius = reference_radius(specimens);
  size.value = std::clamp(line.slope, kLowest, kHighest);
  size.interval = {kLowest, kHighest};
  if (specimens.size() > 2) {
    constexpr double kTwoSided95 = 0.975;
    const boost::math::students_t distribution(static_cast<double>(specimens.size()) - 2.0);
    const double half = boost::math::quantile(distribution, kTwoSided95) * line.error;
    size.interval = {std::max(kLowest, line.slope - half), std::min(kHighest, line.slope + half)};
    size.determined = size.value == line.slope && 2.0 * half <= SizeExponent::kWidest;
  }
  return size;
}

std::vector<double> size_factors(const std::vector<Specimen>& specimens,
                                 const std::optional<SizeExponent>& size) {
  std::vector<double> factors(specimens.size(), 1.0);
  if (!size) return factors;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    factors[i] = model::size_factor(size->value, size->reference_radius, specimens[i].tip_radius);
  }
  return factors;
}

std::vector<Specimen> at_reference(std::vector<Specimen> specimens, const std::optional<SizeExponent>& size) {
  const std::vector<double> factors = size_factors(specimens, size);
  for (std::size_t i = 0; size && i < specimens.size(); ++i) {
    for (double& force : specimens[i].force) force /= factors[i];
  }
  return specimens;
}

std::string undetermined_size(const SizeExponent& size) {
  if (size.determined) return "";
  return fmt::format(
      "size_exponent = {} is not determined: its interval is {} to {}. Measure three specimens or more, with "
      "radii that differ by a factor 2 or more",
      brief(size.value), brief(size.interval.low), brief(size.interval.high));
}

}  // namespace palpate::identify
