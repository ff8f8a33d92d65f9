#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace palpate::psychophysics {

/// One set of parameters of a psychometric function.
struct Parameters {
  double location = 0.0;  // threshold (Weibull) or mean (normal), in the unit of the stimulus level
  double spread = 1.0;    // slope (Weibull) or standard deviation (normal)
  double lapse = 0.0;     // error rate at high levels (Weibull), share of random answers (normal)
};

/// Probability of the counted response at a stimulus level x.
struct PsychometricFunction {
  enum class Shape {
    kWeibull,  // 1 - l - (1 - g - l) exp(-10^(slope (x - threshold) unit)): correct, of x in logarithms
    kNormal    // l/2 + (1 - l) Phi((x - mean)/sd): "second interval", of a signed x
  };
  Shape shape = Shape::kWeibull;
  double guess = 0.5;             // g of the Weibull function: 1/m of m intervals
  double decades_per_unit = 1.0;  // of the Weibull function: 1 for log10 units, 1/20 for dB

  /// [any] Has the same bits on any x86-64.
  [[nodiscard]] double operator()(double level, const Parameters& at) const noexcept;
};

/// Values of one parameter and their prior weights, which need no sum of 1. No weights: all are equal.
struct GridAxis {
  std::vector<double> values;
  std::vector<double> weights = {};

  /// [any] Prior weight of a value.
  [[nodiscard]] double weight(std::size_t i) const { return weights.empty() ? 1.0 : weights[i]; }
};

/// An adaptive method's stimuli and grid of parameters.
struct QuestPlusGrid {
  PsychometricFunction function = {};
  std::vector<double> levels;  // of the stimuli, in ascending order
  GridAxis location, spread, lapse;
  bool lapse_is_nuisance = true;  // place stimuli to learn location and spread alone [Prins 2013]
  int most_repeats = 3;           // most equal stimuli in succession; 0: no limit
};

/// [setup] Grid for the detection of a vibration or force in two intervals. Levels are log10 of the
/// amplitude; the threshold's prior is normal with 0.6 decades about the middle of the range.
/// @param from, to amplitudes > 0, in any unit @param per_decade number of stimuli per factor of ten
/// @throws ParameterError unless 0 < from < to and per_decade > 0
[[nodiscard]] QuestPlusGrid detection_grid(double from, double to, int per_decade);

/// [setup] Grid for the comparison of two stimuli, of which the second is counted. Levels are
/// ln(second/first) of both signs; location is the interval bias. Priors are normal: of the bias with 0.08,
/// of log10 of the standard deviation with 0.5 about -0.7, a just noticeable difference of 14 %.
/// @param least, largest ratios > 1 @param steps number of ratios; their logarithms form a geometric series
/// @throws ParameterError unless 1 < least < largest and steps >= 2
[[nodiscard]] QuestPlusGrid difference_grid(double least = 1.02, double largest = 3.3, int steps = 14);

/// [any] log10 of the amplitude with 75 % correct in two intervals without lapses (d' = 0.954).
[[nodiscard]] double threshold_of(const Parameters& at) noexcept;
/// [any] log10 of the just noticeable difference e^(0.6745 sd) - 1, at 75 % without bias and lapses.
[[nodiscard]] double log10_difference_of(const Parameters& at) noexcept;

/// A quantity's posterior distribution.
struct Estimate {
  double mean = 0.0;
  double sd = 0.0;
  double low = 0.0;  // central 95 % interval
  double high = 0.0;
};

/// QUEST+: Bayesian estimation of a psychometric function with the stimuli that leave the least expected
/// entropy of its parameters [Watson 2017]. A log of stimuli and responses replays alike on any x86-64.
class QuestPlus final {
 public:
  /// [setup] @throws ParameterError for an empty axis, levels that do not ascend or an invalid parameter.
  explicit QuestPlus(QuestPlusGrid grid);

  /// [setup] Starts again from the prior.
  void reset();

  /// [setup] Index of the next stimulus: the least expected entropy. Within 1e-9 nats, the first such level.
  /// A stimulus that was shown most_repeats times in succession is left out.
  [[nodiscard]] std::size_t next() const;

  /// [setup] Expected entropy [nats] of the parameters after one more trial, for each level; without the
  /// lapse rate where it is a nuisance.
  [[nodiscard]] std::vector<double> expected_entropies() const;

  /// [setup] Adds a trial. @param level index of its stimulus @param counted correct (Weibull), "second"
  /// (normal) @throws ParameterError for a level that does not exist
  void update(std::size_t level, bool counted);

  /// [setup] Posterior mean, standard deviation and 95 % interval of any function of the parameters.
  [[nodiscard]] Estimate estimate(const std::function<double(const Parameters&)>& quantity) const;

  /// [setup] Larger of the probabilities of the first and the last location. Above 0.01 the range of stimuli
  /// is too small for an estimate.
  [[nodiscard]] double edge_probability() const;

  /// [setup] Whether the posterior probability of a lapse rate of at least 5 % exceeds 0.4. After 80
  /// trials this finds 2 of 3 people with 10 % lapses, and 1 of 25 without.
  [[nodiscard]] bool lapses_often() const;

  [[nodiscard]] const QuestPlusGrid& grid() const noexcept { return grid_; }
  /// [any] Posterior probabilities, in the order location, spread, lapse (fastest).
  [[nodiscard]] std::span<const double> posterior() const noexcept { return posterior_; }

 private:
  // A part of the posterior whose entropy counts: a cell, or a pair of location and spread.
  struct Group {
    std::size_t pair = 0;
    double probability = 0.0;
    double lapse = 0.0;  // mean
  };
  [[nodiscard]] Parameters parameters_at(std::size_t cell) const;
  [[nodiscard]] double counted(std::size_t level, std::size_t pair, double lapse) const noexcept;
  [[nodiscard]] std::vector<Group> groups() const;
  [[nodiscard]] double expected_gain(std::size_t level, const std::vector<Group>& groups) const noexcept;

  QuestPlusGrid grid_;
  std::vector<double> prior_;
  std::vector<double> posterior_;
  // Probability of the counted response without lapses, and its derivative by the lapse rate, in which it is
  // linear: for each level and pair of location and spread.
  std::vector<double> without_lapse_, by_lapse_;
  std::size_t last_level_ = 0;
  int repeats_ = 0;
};

/// Number of trials, and of those with the counted response.
struct Count {
  int trials = 0;
  int counted = 0;
};

/// Sensitivity and criterion of signal detection theory [Macmillan and Creelman 2005].
struct Sensitivity {
  double d_prime = 0.0;
  double criterion = 0.0;  // c; > 0: a tendency to "no", or to "second interval"
  double ln_beta = 0.0;    // logarithm of the likelihood ratio at the criterion
  bool reliable = false;   // false: a rate is below 0.05 or above 0.95, and no statement may be made
};

/// [setup] Yes/no task: d' = z(H) - z(F), c = -(z(H) + z(F))/2. Infinite for a rate of 0 or 1, unless 1/2 is
/// added to each count and 1 to each number of trials (log-linear correction, which biases d').
/// @param hits "yes" with a signal @param false_alarms "yes" without
/// @throws ParameterError unless 0 <= counted <= trials and trials > 0
[[nodiscard]] Sensitivity yes_no(const Count& hits, const Count& false_alarms, bool log_linear = false);

/// [setup] Two-interval task: d' = (z(H1) + z(H2))/sqrt 2, c = (z(H2) - z(H1))/2.
/// @param first correct answers with the signal in the first interval @param second in the second
/// @throws ParameterError unless 0 <= counted <= trials and trials > 0
[[nodiscard]] Sensitivity two_interval(const Count& first, const Count& second, bool log_linear = false);

/// [setup] Probability of a correct answer among m intervals without bias, and d' for this probability.
/// @throws ParameterError unless m >= 2; d' also unless 0 < correct < 1
[[nodiscard]] double correct_of_d_prime(double d_prime, int intervals);
[[nodiscard]] double d_prime_of_correct(double correct, int intervals);

/// A transformed and weighted up-down staircase [Levitt 1971; Kaernbach 1991]: one incorrect answer moves the
/// level up, `down` correct answers in succession move it down.
struct StaircaseSetup {
  double start = 0.0;                     // level of the first stimulus, usually a logarithm
  int down = 2;                           // correct answers: converges to 0.5^(1/down) correct
  std::vector<double> steps = {4, 2, 1};  // upward steps; each is used for reversals_per_step reversals
  int reversals_per_step = 2;             // the last step stays
  double down_ratio = 1.0;                // downward over upward step r: converges to (1 + r)^(-1/down)
  double least = -1e9;                    // limits of the level
  double largest = 1e9;
  int discarded = 6;  // first reversals that the mean leaves out
};

class Staircase final {
 public:
  /// [setup] @throws ParameterError naming an invalid value of the set-up.
  explicit Staircase(StaircaseSetup setup);

  /// [any] Level of the next stimulus.
  [[nodiscard]] double level() const noexcept { return level_; }
  /// [setup] Adds the answer to the stimulus at level().
  void update(bool correct);
  /// [any] Levels at which the direction changed.
  [[nodiscard]] std::span<const double> reversals() const noexcept { return reversals_; }
  /// [setup] Mean of the reversals after the discarded ones; empty with fewer than two of them.
  [[nodiscard]] std::optional<double> mean() const;

 private:
  StaircaseSetup setup_;
  double level_ = 0.0;
  int correct_in_succession_ = 0;
  int direction_ = 0;  // of the last step: 1 up, -1 down, 0 before the first
  std::vector<double> reversals_;
};

/// A simulated observer. Signals, noise and internal noise are in units of its detection threshold T = 1,
/// except for the fitted function of kFunction, which has levels of its own.
struct Observer {
  enum class Kind {
    kFunction,   // answers by `function`, without any effect of the noise
    kLinear,     // d' = signal/sqrt(internal noise^2 + noise^2)
    kThreshold,  // counts the samples above T; the interval with more of them has the signal
    kRandom
  };
  Kind kind = Kind::kFunction;
  PsychometricFunction function = {};
  Parameters parameters = {0.0, 2.5, 0.0};
  double internal_noise = 0.35;  // standard deviation
  int samples = 10;              // per interval, of kThreshold
  double lapse = 0.0;            // share of random answers
  double drift = 0.0;            // rise of the threshold or sd from start to end of a session, in log10
};

/// [setup] A named observer: ideal, linear, sr, lapse, random, tires or learns. @throws InputError for
/// another name
[[nodiscard]] Observer make_observer(std::string_view name);

struct ObserverTrial {
  double level = 0.0;     // of the signal, or ln(second/first) of a comparison
  double noise = 0.0;     // standard deviation of the noise in both intervals
  bool second = false;    // the signal is in the second interval; unused in comparisons
  double progress = 0.0;  // elapsed share of the session
  // Standard deviation in the interval without the signal; empty: as in the other one. Of kThreshold.
  std::optional<double> noise_without{};
};

/// [any] Probability of the answer "second" in a task with two intervals.
[[nodiscard]] double probability_second(const Observer& observer, const ObserverTrial& trial) noexcept;

/// [any] An answer with this probability. It depends on the four numbers alone, on any machine.
[[nodiscard]] bool draw_answer(double probability, std::uint64_t seed, std::uint32_t participant,
                               std::uint32_t trial) noexcept;

}  // namespace palpate::psychophysics
