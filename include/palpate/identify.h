#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/tissue.h"

namespace palpate::tasks {
class Ranks;
}

namespace palpate::identify {

/// One measured force over displacement, pressed or pulled; both count positive. SI.
struct Specimen {
  std::string name;
  std::vector<double> time;          // s, rising; empty when the file has none
  std::vector<double> displacement;  // m
  std::vector<double> force;         // N
  std::size_t empty_rows = 0;        // that were left out by read_specimens()

  [[nodiscard]] std::size_t size() const noexcept { return force.size(); }
};

inline constexpr std::size_t kFewestPoints = 10;

/// [setup] The specimens of one CSV file with columns displacement_mm, force_N and optionally time_s and
/// specimen, by header name; lines that begin with # and blank lines do not count. A file without a specimen
/// column is one specimen, named after the file. Rows of 0 mm and 0 N after others are left out: a rig that
/// stops at its force limit leaves such.
/// @throws InputError naming file, line, column and value, or file and specimen: no such file, a header that
/// is missing or unknown, a value that is no finite number, time that does not rise, fewer than kFewestPoints
/// rows, a displacement or force that never changes, a force that does not rise out of its noise, signs other
/// than the contract's.
[[nodiscard]] std::vector<Specimen> read_specimens(const std::filesystem::path& file);

/// [setup] At most `most` points, each the mean of as many neighbours as that takes: neighbours in time, or,
/// without times, in displacement. A specimen that has no more is returned as it is.
[[nodiscard]] Specimen thinned(const Specimen& specimen, std::size_t most);

/// What is fitted, and how its intervals are found. SI.
struct Settings {
  model::LawKind law = model::LawKind::kLayered;
  model::Direction direction = model::Direction::kPress;
  bool relaxation = false;  // as many terms as the data bear, at least one
  double period = 1e-3;     // T of the loop [s], which with t1 decides how many layers move
  double t1 = 1e-6;         // [s]
  int bootstrap = 0;        // resamples for a second kind of interval
  std::uint64_t seed = 1;
};

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
/// the sensor's zero is right to some percent. Where the lowest force is more, the data begin after contact
/// or the sensor is off by as much, and both spreads grow by that share of the range.
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
  std::vector<double> low;  // band of the curves that the data allow at 95 %
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
/// @param ranks share the bootstrap, all of them making this call; null: this process alone
/// @throws InputError when relaxation is asked for without times, or the specimen has too few points.
[[nodiscard]] SpecimenFit fit_specimen(const Specimen& specimen, const Settings& settings, std::uint32_t job,
                                       const Progress& progress, tasks::Ranks* ranks = nullptr);

/// [setup] Fits specimens together, from their own fits (one a specimen, as many relaxation terms as most of
/// them have); each counts the same, however many points and newtons it has. The intervals are of the mean
/// tissue: specimens are resampled, so they hold how much specimens differ, and besides every value that
/// leaves the specimens as well fitted when the others are fitted again. One specimen: its own fit.
/// @param ranks share the resamples, all of them making this call; null: this process alone
[[nodiscard]] PooledFit fit_pooled(const std::vector<Specimen>& specimens,
                                   const std::vector<SpecimenFit>& fits, const Settings& settings,
                                   const Progress& progress, tasks::Ranks* ranks = nullptr);

}  // namespace palpate::identify
