#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "palpate/fit/settings.h"
#include "palpate/fit/specimen.h"
#include "palpate/model/tissue.h"

namespace palpate::fit {

/// The parameters of a fit stand in one order everywhere: first those that specimens of one tissue share,
/// k_1, beta, q, L_1 and for each relaxation term its share and time; then a specimen's own two,
/// first-contact depth and sensor offset.
///
/// A Point holds them as the solver sees them: ln k_1, ln beta, ln q, ln L_1; ln(share_i / what lasts) and
/// ln time_i; and the two offsets in shares of the specimen's ranges of displacement and force.
using Point = std::vector<double>;

inline constexpr std::size_t kLawParameters = 4;
inline constexpr std::size_t kOwnParameters = 2;

/// [any] How many parameters are shared with `terms` relaxation terms.
[[nodiscard]] constexpr std::size_t shared_count(std::size_t terms) noexcept {
  return kLawParameters + 2 * terms;
}

/// Lowest and highest displacement [m] and force [N], and the way from one to the other.
struct Ranges {
  double lowest_displacement = 0.0;
  double displacement = 0.0;
  double lowest_force = 0.0;
  double force = 0.0;
  double duration = 0.0;       // s; 0 without times
  double shortest_step = 0.0;  // s
};

/// [setup] @throws InputError when displacement or force never change.
[[nodiscard]] Ranges ranges_of(const Specimen& specimen);

/// Lowest and highest that a parameter may become.
struct Bounds {
  Point low;
  Point high;
};

/// What is taken for known of a specimen's own two before it is fitted: where they are likely to be, and how
/// likely it is that they are elsewhere (a normal distribution, cut off at five spreads).
struct OwnPrior {
  double first_contact = 0.0;          // in shares of the range of displacement
  double first_contact_spread = 0.05;  // standard deviation, in the same: how well it is found by hand
  double offset = 0.0;                 // in shares of the range of force
  double offset_spread = 0.02;
};

/// [setup] First contact at displacement 0, or at the first point when displacements count from elsewhere;
/// the sensor's zero is right to some percent.
[[nodiscard]] OwnPrior own_prior(const Ranges& ranges);

/// [setup] The displacement [m] up to which the best straight line through the data does not rise, as far as
/// the noise lets one tell: a way without contact, or a first layer too soft to be told from one. The lowest
/// displacement when the force rises at once.
[[nodiscard]] double flat_until(const Specimen& specimen, const Ranges& ranges);

/// [setup] Bounds of the shared parameters, for data of these ranges.
[[nodiscard]] Bounds shared_bounds(const Ranges& ranges, std::size_t terms);
/// [setup] Bounds of a specimen's own.
[[nodiscard]] Bounds own_bounds(const OwnPrior& prior);

/// [setup] Values in SI of a point: shared and own parameters in the order above, relaxation terms by rising
/// time.
[[nodiscard]] std::vector<double> values_of(std::span<const double> shared, std::span<const double> own,
                                            const Ranges& ranges);

/// [setup] The tissue of shared parameters: rest length 2 L_1, the other direction the same L_1.
[[nodiscard]] model::TissueParameters tissue_of(std::span<const double> shared, const Settings& settings);

/// A parameter as users see it.
struct ParameterLabel {
  std::string name;    // "k1_N_per_m", "relaxation 1 share", ...
  double unit = 1.0;   // SI in one of its units
  bool shared = true;  // with other specimens of the tissue
};

/// [any] Labels in the order of values_of().
[[nodiscard]] std::vector<ParameterLabel> labels(std::size_t terms);

}  // namespace palpate::fit
