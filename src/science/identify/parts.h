#pragma once
#include <vector>

#include "science/identify/least_squares.h"

namespace palpate::identify {

/// [setup] The points of a specimen that its own fit takes: means of neighbours where it has very many.
[[nodiscard]] Specimen as_fitted(const Specimen& specimen, const Settings& settings);

/// [setup] The points of specimens that the fit of all together takes.
[[nodiscard]] std::vector<Specimen> as_pooled(const std::vector<Specimen>& specimens);

/// [setup] A part for each of as_pooled()'s specimens, which must outlive them; each counts the same, however
/// many points it has.
[[nodiscard]] std::vector<Part> pooled_parts(const std::vector<Specimen>& pooled);

}  // namespace palpate::identify
