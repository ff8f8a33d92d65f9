#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "science/identify/intervals.h"
#include "science/identify/minima.h"

namespace palpate::identify {

/// [any] Identifiability of a parameter: where its interval [logarithms] lies within the searched range.
enum class Determined { kYes, kEndsWhereTheSearchEnds, kSpansMost };
[[nodiscard]] Determined determined_by(double low, double high, double lowest, double highest);

/// [any] Warning "q is not determined by the data: ...", for any result but kYes.
[[nodiscard]] std::string undetermined_warning(Determined how, const ParameterLabel& label,
                                               const Interval& interval);

/// [setup] Identifiability of each shared parameter, from points in the confidence set.
[[nodiscard]] std::vector<Determined> determined_of(const Minima& minima, const std::vector<Point>& points);

/// [setup] Warnings about a specimen's fit, one sentence each: undetermined parameters, outliers, averaged
/// rows, layers not reached, hysteresis.
[[nodiscard]] std::vector<std::string> warnings_of(const Minima& minima, const std::vector<Point>& points,
                                                   const Curvature& curvature, const SpecimenFit& fit);

}  // namespace palpate::identify
