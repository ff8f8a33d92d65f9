#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"

#include "fit/identify/intervals.h"
#include "fit/identify/local_optima.h"

namespace palpate::identify {

/// [any] Identifiability of a parameter: where its interval [logarithms] lies within the searched range.
enum class Identifiability { kIdentifiable, kAtSearchBound, kSpansSearchRange };
[[nodiscard]] Identifiability identifiability_of_interval(double low, double high, double lowest,
                                                          double highest);

/// [any] Warning "q is not determined by the data: ...", for any result but kIdentifiable.
[[nodiscard]] std::string undetermined_warning(Identifiability how, const ParameterLabel& label,
                                               const Interval& interval);

/// [setup] Identifiability of each shared parameter, from points in the confidence set.
[[nodiscard]] std::vector<Identifiability> identifiability_of(const LocalOptima& optima,
                                                              const std::vector<Point>& points);

/// [setup] One sentence for each set of parameters that are determined together, as chains of correlated
/// pairs.
[[nodiscard]] std::vector<std::string> correlated_warnings(
    const std::vector<std::vector<double>>& correlations, const std::vector<ParameterLabel>& names);

/// What is doubtful about a fit, in words.
struct Misfit {
  std::vector<std::string> warnings;
  std::string poor;        // why no tissue may come from the fit; empty: one may
  std::string nearer_law;  // that the other law leaves less than half the error; empty where it does not
};

/// [setup] Warnings about a specimen's fit, one sentence each: undetermined parameters, outliers, averaged
/// rows, layers not reached, what was subtracted or excluded before the fit. Poor: another law or
/// first contact gives more than twice the force, or a straight beginning may be a tilted sensor.
/// @param nearer_law of misfit_of()
[[nodiscard]] Misfit warnings_of(const LocalOptima& optima, const std::vector<Point>& points,
                                 const Curvature& curvature, const SpecimenFit& fit,
                                 const std::string& nearer_law);

/// [setup] Compares a fit with the measured curve where a simulation needs it, in the deeper half of its
/// depth: the means of neighbours against the fitted force, and the place from which the force rises against
/// the fitted first contact. A difference over kPoorFit of the force there is poor. Where the law does not
/// follow the curve, the other law is fitted too, and a warning says which is nearer.
[[nodiscard]] Misfit misfit_of(const LocalOptima& optima, const SpecimenFit& fit);

}  // namespace palpate::identify
