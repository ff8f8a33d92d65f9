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
class Communicator;
}

namespace palpate::identify {

/// What the first rows of a specimen show, and what a fit subtracts from its forces for that
/// (docs/fitting.md, "Before the fit"). SI units.
struct Preparation {
  std::size_t rows = 0;     // number of rows fitted
  double zero = 0.0;        // N, sensor reading without contact at `zero_at`, subtracted from the forces
  double zero_at = 0.0;     // m
  double zero_slope = 0.0;  // N/m, drift or tilt of that reading, subtracted too
  double zero_curve = 0.0;  // N/m^2, how this slope changes, subtracted too
  std::optional<double> contact;   // m, where the rows without contact end
  double noise = 0.0;              // N, standard deviation
  double contact_error = 0.0;      // m, uncertainty of first contact from the noise of the first rows
  std::vector<std::string> notes;  // one sentence each
  std::string doubt;               // a warning for a fit with a larger error than the noise
  std::string poor;                // why no tissue may come from these rows; empty: one may

  /// [any] Subtracted force [N] at a displacement [m].
  [[nodiscard]] double baseline(double displacement) const noexcept {
    const double from = displacement - zero_at;
    return zero + (zero_slope + zero_curve * from) * from;
  }
};

/// One measured curve of force over displacement, pressed or pulled; both count positive. SI units.
struct Specimen {
  std::string name;
  std::vector<double> time;          // s, increasing; empty when the file has no times
  std::vector<double> displacement;  // m
  std::vector<double> force;         // N
  std::size_t empty_rows = 0;        // number of rows that read_specimens() omitted
  Preparation preparation = {};      // of prepared(); empty before
  double tip_radius = 0.0;           // m, of the indenter; 0: not known

  [[nodiscard]] std::size_t size() const noexcept { return force.size(); }
};

inline constexpr std::size_t kFewestPoints = 10;

/// [setup] Reads the specimens of a CSV file. Columns, by header name: displacement_mm, force_N and
/// optionally time_s, specimen and indenter_radius_mm. Lines that begin with # and blank lines are ignored. A
/// file without a specimen column is one specimen, named after the file. Rows of another indenter are another
/// specimen. Rows of 0 mm and 0 N after other rows are omitted:
/// a rig that stops at its force limit writes them.
/// @throws InputError that names file, line, column and value, or file and specimen. Causes: no such file, a
/// missing or unknown header, a value that is not a finite number, a radius that no indenter has, times that
/// do not increase, fewer than kFewestPoints rows. Causes in a specimen: a constant displacement or force, a
/// force that does not rise out of its noise, wrong signs.
[[nodiscard]] std::vector<Specimen> read_specimens(const std::filesystem::path& file);

/// [setup] Reduces a specimen to at most `most` points, each the mean of neighbours: neighbours in time or,
/// without times, in displacement. A specimen with no more points is returned unchanged.
[[nodiscard]] Specimen thinned(const Specimen& specimen, std::size_t most);

/// Settings of a fit. SI units.
struct Settings {
  model::LawKind law = model::LawKind::kLayered;
  model::Direction direction = model::Direction::kPress;
  bool relaxation = false;  // fit as many relaxation terms as the data support, at least one
  double period = 1e-3;     // T of the loop [s]; with t1 it determines the number of layers
  double t1 = 1e-6;         // duration t_1 [s] of the law's layer count
  int bootstrap = 0;        // number of bootstrap resamples; 0: none
  std::uint64_t seed = 1;
};

/// Parameters in their fixed order: first those that all specimens of a tissue share (k_1, beta, q, L_1, and
/// for each relaxation term its weight g_i and time tau_i), then a specimen's own two (first-contact depth,
/// sensor offset).
///
/// A Point holds the parameters in the form that the solver uses: ln k_1, ln beta, ln q, ln L_1; ln(g_i /
/// g_inf), ln tau_i; and the two own parameters as fractions of the specimen's ranges of displacement and
/// force.
using Point = std::vector<double>;

inline constexpr std::size_t kLawParameters = 4;
inline constexpr std::size_t kOwnParameters = 2;

/// [any] Number of shared parameters with `terms` relaxation terms.
[[nodiscard]] constexpr std::size_t shared_count(std::size_t terms) noexcept {
  return kLawParameters + 2 * terms;
}

/// Lowest displacement [m] and force [N], and their ranges (highest minus lowest).
struct Ranges {
  double lowest_displacement = 0.0;
  double displacement = 0.0;
  double lowest_force = 0.0;
  double force = 0.0;
  double duration = 0.0;       // s; 0 without times
  double shortest_step = 0.0;  // s
};

/// [setup] @throws InputError when displacement or force is constant.
[[nodiscard]] Ranges ranges_of(const Specimen& specimen);

/// Lower and upper bounds of parameters.
struct Bounds {
  Point low;
  Point high;
};

/// Prior of a specimen's own two parameters: a normal distribution, truncated at five standard deviations.
struct OwnPrior {
  double first_contact = 0.0;          // mean, as a fraction of the displacement range
  double first_contact_spread = 0.05;  // standard deviation: how accurately it is found by hand
  double offset = 0.0;                 // mean, as a fraction of the force range
  double offset_spread = 0.02;
};

/// [setup] Prior with first contact at displacement 0, or at the first point when displacements do not start
/// near 0; the sensor offset is accurate to some percent. When the lowest force is larger than that, the data
/// begin after contact or the sensor has an offset, and both standard deviations grow by that fraction of the
/// range.
[[nodiscard]] OwnPrior own_prior(const Ranges& ranges);

/// [setup] Displacement [m] up to which the least-squares line through the data does not rise beyond the
/// noise. The tool has no contact there, or the first layer is too soft to be distinguished from no contact.
/// It is the lowest displacement when the force rises at once.
[[nodiscard]] double flat_until(const Specimen& specimen, const Ranges& ranges);

/// [setup] Bounds of the shared parameters, for data of these ranges.
[[nodiscard]] Bounds shared_bounds(const Ranges& ranges, std::size_t terms);
/// [setup] Bounds of a specimen's own parameters.
[[nodiscard]] Bounds own_bounds(const OwnPrior& prior);

/// [setup] Values of a point in SI units: shared, then own parameters, relaxation terms by increasing time.
[[nodiscard]] std::vector<double> values_of(std::span<const double> shared, std::span<const double> own,
                                            const Ranges& ranges);

/// [setup] The tissue with these shared parameters: rest length 2 L_1, and the same L_1 in the other
/// direction.
[[nodiscard]] model::TissueParameters tissue_of(std::span<const double> shared, const Settings& settings);

/// Name and unit of a parameter in files and reports.
struct ParameterLabel {
  std::string name;    // "k1_N_per_m", "relaxation 1 share", ...
  double unit = 1.0;   // value of the unit in SI
  bool shared = true;  // shared by all specimens of the tissue
};

/// [any] Labels in the order of values_of().
[[nodiscard]] std::vector<ParameterLabel> labels(std::size_t terms);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Estimate of one parameter. SI units.
struct Estimate {
  double value = 0.0;
  Interval interval;                   // 95 % interval from the profile likelihood
  std::optional<Interval> covariance;  // 95 % interval from the covariance matrix; empty where it is singular
  std::optional<Interval> bootstrap;   // 95 % interval of Settings::bootstrap resamples
  bool determined = true;              // identifiable; false: the interval reaches a bound of the search, or
                                       // spans most of its range
};

/// Measured and fitted curve of a specimen, point by point. SI units.
struct Curve {
  std::vector<double> time;  // empty without times
  std::vector<double> displacement;
  std::vector<double> measured;
  std::vector<double> fitted;
  std::vector<double> low;  // envelope of the curves in the 95 % confidence set
  std::vector<double> high;
};

/// The fit of one specimen.
struct SpecimenFit {
  std::string name;
  model::LawKind law = model::LawKind::kLayered;
  int layers_allowed = 0;
  int layers_reached = 0;           // reached at the largest depth
  std::size_t terms = 0;            // number of relaxation terms
  std::vector<Estimate> estimates;  // in the order of labels(terms)
  double rms = 0.0;                 // N, over all points
  double nrmse = 0.0;               // rms / force range
  double cross_validation = 0.0;    // error of k-fold cross-validation: nrmse of points that their fit did
                                    // not use
  std::size_t points = 0;           // number of points fitted
  std::size_t rows = 0;             // number of rows in the file
  std::vector<std::string> warnings;
  std::string poor;  // why no tissue may come from this fit although its error is small; empty: one may
  Curve curve;
  Point shared;  // of the best fit
  Point own;
  std::vector<Point> local_optima;  // other local optima, best first: shared, then own parameters
};

/// How the force grows with the indenter's radius: as (radius / reference_radius)^value.
struct SizeExponent {
  static constexpr double kWidest =
      1.0;  // of an interval that still tells a ball (0.5) from 0 or a punch (1)

  double value = 0.0;             // within 0 to 2
  Interval interval;              // 95 %, from how the specimens differ; 0 to 2 with two specimens
  bool determined = false;        // three specimens or more, and the interval is not wider than kWidest
  double reference_radius = 0.0;  // m, one of the specimens'
};

/// Pooled fit of all specimens: one set of shared parameters, own parameters for each specimen.
struct PooledFit {
  model::Direction direction = model::Direction::kPress;
  std::vector<Estimate> estimates;  // shared parameters, in the order of labels(terms)
  std::size_t terms = 0;
  int layers_allowed = 0;
  int layers_reached = 0;
  double rms = 0.0;    // N, over all points of all specimens
  double nrmse = 0.0;  // root of the mean over specimens of (rms/range)^2
  std::size_t points = 0;
  std::size_t specimens = 0;
  std::optional<SizeExponent> size;  // of specimens with clearly different indenters
  std::vector<std::string> warnings;
  model::TissueParameters tissue;
  Point shared;            // of the best fit
  std::vector<Point> own;  // one per specimen
};

// Largest errors (nrmse) of a fit, of the force range.
inline constexpr double kPoorFit = 0.2;  // no tissue comes from a fit with a larger error
inline constexpr double kNoFit = 1.0;    // a larger error is refused: a constant force has a smaller one

/// [setup] What is wrong with these fits: the one with the largest error, if that is over `limit`, or the
/// first that is poor for another reason, with kPoorFit; otherwise empty.
[[nodiscard]] std::string poor_fit(std::span<const SpecimenFit> fits, const PooledFit& pooled,
                                   double limit = kPoorFit);

/// Receives the completed fraction, 0..1, and a description of the current step.
using Progress = std::function<void(double, const std::string&)>;

/// [setup] Fits one specimen. @param job index of the specimen; selects its random numbers
/// @param ranks share the bootstrap and must all make this call; null: this process only
/// @throws InputError when relaxation is requested without times, or the specimen has too few points.
[[nodiscard]] SpecimenFit fit_specimen(const Specimen& specimen, const Settings& settings, std::uint32_t job,
                                       const Progress& progress, tasks::Communicator* ranks = nullptr);

/// [setup] Fits all specimens together. `fits` holds the fit of each specimen; the pooled fit starts from
/// them and uses the most frequent number of relaxation terms. All specimens have the same weight. The
/// intervals are those of the mean tissue: they unite a bootstrap over the specimens (how much specimens
/// differ) and the profile of each law parameter. For one specimen the result is its own fit. Specimens with
/// clearly different indenters give the size exponent, and are fitted as the reference indenter would have
/// measured them. The tissue has the radius of the indenters as its source.
/// @param ranks share the resamples and must all make this call; null: this process only
[[nodiscard]] PooledFit fit_pooled(const std::vector<Specimen>& specimens,
                                   const std::vector<SpecimenFit>& fits, const Settings& settings,
                                   const Progress& progress, tasks::Communicator* ranks = nullptr);

}  // namespace palpate::identify
