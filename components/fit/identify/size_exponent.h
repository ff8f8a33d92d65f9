#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// Radii differ clearly when the largest is more than this times the smallest: below it a force would change
/// by less than 12 % (Hertz), as specimens of one tissue differ.
inline constexpr double kClearlyDifferent = 1.25;

/// [setup] The size exponent that the specimens' own fits show, where their indenters differ clearly: the
/// slope of ln F over the ln of the radius, F the force of each fit at the same depths. The interval comes
/// from how the specimens scatter about that line, so it has two specimens less than there are as degrees of
/// freedom.
/// @param fits the fit of each specimen @throws InputError when only some specimens have a radius
[[nodiscard]] std::optional<SizeExponent> fit_size_exponent(const std::vector<Specimen>& specimens,
                                                            const std::vector<SpecimenFit>& fits,
                                                            const Settings& settings);

/// [setup] The factor of each specimen's force against that of the reference radius; 1 without an exponent.
[[nodiscard]] std::vector<double> size_factors(const std::vector<Specimen>& specimens,
                                               const std::optional<SizeExponent>& size);

/// [setup] The specimens as an indenter of the reference radius would have measured them.
[[nodiscard]] std::vector<Specimen> at_reference(std::vector<Specimen> specimens,
                                                 const std::optional<SizeExponent>& size);

/// [setup] The radius that the tissue of these specimens was measured with [m]: the one nearest to the middle
/// of the ln of the radii; 0 when they have none.
[[nodiscard]] double reference_radius(const std::vector<Specimen>& specimens);

/// [setup] What is to be said of an exponent that the data do not determine; otherwise empty.
[[nodiscard]] std::string undetermined_size(const SizeExponent& size);

}  // namespace palpate::identify
