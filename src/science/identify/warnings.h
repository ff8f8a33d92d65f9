#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "science/identify/intervals.h"
#include "science/identify/minima.h"

namespace palpate::identify {

/// [any] Where an interval [logarithms] of a parameter stands within what was tried.
enum class Determined { kYes, kEndsWhereTheSearchEnds, kSpansMost };
[[nodiscard]] Determined determined_by(double low, double high, double lowest, double highest);

/// [any] "q is not determined by the data: ...", for an interval that determined_by() says so of.
[[nodiscard]] std::string undetermined_warning(Determined how, const ParameterLabel& label,
                                               const Interval& interval);

/// [setup] Says of each shared parameter, by points that the data allow, whether they determine it.
[[nodiscard]] std::vector<Determined> determined_of(const Minima& minima, const std::vector<Point>& points);

/// [setup] What a user should know of a specimen's fit before believing it, a sentence each: parameters that
/// the data do not determine, outliers, rows that were averaged, layers that were not reached, hysteresis.
[[nodiscard]] std::vector<std::string> warnings_of(const Minima& minima, const std::vector<Point>& points,
                                                   const Curvature& curvature, const SpecimenFit& fit);

}  // namespace palpate::identify
