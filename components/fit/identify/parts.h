#pragma once
#include <vector>

#include "fit/identify/least_squares.h"

namespace palpate::identify {

/// [setup] The points used for a specimen's own fit: averages of neighbours when there are too many points.
[[nodiscard]] Specimen as_fitted(const Specimen& specimen, const Settings& settings);

/// [setup] The points used for the pooled fit.
[[nodiscard]] std::vector<Specimen> as_pooled(const std::vector<Specimen>& specimens);

/// [setup] One part per specimen of as_pooled(), which must outlive the parts. All specimens have the same
/// total weight, whatever their number of points.
[[nodiscard]] std::vector<Part> pooled_parts(const std::vector<Specimen>& pooled);

}  // namespace palpate::identify
