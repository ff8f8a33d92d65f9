#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/fit/crew.h"
#include "palpate/fit/parameters.h"
#include "palpate/fit/settings.h"
#include "palpate/fit/specimen.h"
#include "palpate/model/tissue.h"

namespace palpate::fit {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// One parameter of a fit, SI.
struct Estimate {
  double value = 0.0;
  Interval interval;                   // 95 %: the one to believe
  std::optional<Interval> covariance;  // 95 % from the covariance alone; none where it is singular
  std::optional<Interval> bootstrap;   // 95 % of Settings::bootstrap resamples
  bool determined = true;              // false: the interval ends where the search ends, or spans most of it
};

/// What a specimen's curve was and what the fit makes of it, point by point. SI.
struct Curve {
  std::vector<double> time;  // empty without times
  std::vector<double> displacement;
  std::vector<double> measured;
  std::vector<double> fitted;
  std::vector<double> low;  // 95 % band of the fitted curve, from the intervals' ensemble
  std::vector<double> high;
};

/// The fit of one specimen.
struct SpecimenFit {
  std::string name;
  model::LawKind law = model::LawKind::kLayered;
  int layers_allowed = 0;
  int layers_reached = 0;           // by the largest depth
  std::size_t terms = 0;            // of relaxation
  std::vector<Estimate> estimates;  // in the order of labels(terms)
  double rms = 0.0;                 // N, of all points
  double nrmse = 0.0;               // rms over the range of force
  double leave_out = 0.0;           // the same of points that their fit had not seen
  std::size_t points = 0;           // that were fitted
  std::size_t rows = 0;             // of the file
  std::vector<std::string> warnings;
  Curve curve;
  Point shared;  // of the best fit
  Point own;
  std::vector<Point> minima;  // the others that the search kept, best first: shared, then own
};

/// The fit of all specimens together: shared parameters, each specimen's own apart.
struct PooledFit {
  std::vector<Estimate> estimates;  // shared ones only, in the order of labels(terms)
  std::size_t terms = 0;
  int layers_allowed = 0;
  int layers_reached = 0;
  double rms = 0.0;    // N, over all points of all specimens
  double nrmse = 0.0;  // root of the mean over specimens of (rms/range)^2
  std::size_t points = 0;
  std::size_t specimens = 0;
  std::vector<std::string> warnings;
  model::TissueParameters tissue;
  Point shared;            // of the best fit
  std::vector<Point> own;  // of each specimen
};

/// Told what share is done, 0..1, and what is being done now.
using Progress = std::function<void(double, const std::string&)>;

/// [setup] Fits one specimen. @param job its number, for its own random numbers
/// @param crew shares the bootstrap when there is one: then all its members make this call
/// @throws InputError when relaxation is asked for without times, or the specimen has too few points.
[[nodiscard]] SpecimenFit fit_specimen(const Specimen& specimen, const Settings& settings, std::uint32_t job,
                                       const Progress& progress, Crew* crew = nullptr);

/// [setup] Fits specimens together, from their own fits (one a specimen, as many relaxation terms as most of
/// them have); each counts the same, however many points and newtons it has. The intervals are of the mean
/// tissue: specimens are resampled, so they hold how much specimens differ, and besides every value that
/// leaves the specimens as well fitted when the others are fitted again. One specimen: its own fit.
/// @param crew shares the resamples when there is one: then all its members make this call
[[nodiscard]] PooledFit fit_pooled(const std::vector<Specimen>& specimens,
                                   const std::vector<SpecimenFit>& fits, const Settings& settings,
                                   const Progress& progress, Crew* crew = nullptr);

}  // namespace palpate::fit
