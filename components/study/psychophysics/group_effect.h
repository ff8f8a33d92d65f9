#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// One person's counted answers at each level, without and with the noise: "second" of a comparison, correct
/// ones of a detection.
struct PairedCounts {
  std::vector<Count> off, with;
};

/// Effect of the noise on the measure s of the psychometric functions of a group: the standard deviation of a
/// comparison, the threshold at 75 % of a detection.
struct GroupEffect {
  double effect = 0.0;  // Delta, mean of ln(s with/s off): -0.16 means that s is 15 % smaller
  double low = 0.0;     // 95 % interval by the profile likelihood
  double high = 0.0;
  double p_value = 1.0;         // two-sided, of Delta = 0
  double effect_sd = 0.0;       // of ln(s with/s off) between people, at least 0.03
  double mean_ln_spread = 0.0;  // of s without noise
  double ln_spread_sd = 0.0;    // between people, at least 0.08
};

/// Hierarchical likelihood of a group. A person's ln s without noise is N(m, ts), and the change of ln s is
/// N(Delta, td). Interval bias and lapse rate are the same with and without noise, the slope of a detection
/// may differ; they are summed over the grid with its prior. A person whose s lies outside the stimuli is not
/// left out: the answers say that s is at least, or at most, so large.
class GroupModel final {
 public:
  /// [setup] @param grid difference_grid() or detection_grid(): its levels, biases or slopes, lapse rates and
  /// range of s, which reaches beyond the stimuli of a detection
  /// @throws ParameterError for a detection without two intervals or in other units than log10
  explicit GroupModel(const QuestPlusGrid& grid);

  /// [setup] Largest likelihood and interval: twice the decrease of the logarithm of the profile likelihood
  /// is N ln(1 + t^2/(N - 1)), with the 97.5 % quantile t of Student's t with N - 1 degrees of freedom. For
  /// changes that are known exactly this is the interval of a paired t test.
  /// @throws ParameterError for fewer than two people or other numbers of counts than levels
  [[nodiscard]] GroupEffect fit(std::span<const PairedCounts> people) const;

  /// [any] Largest effect of the grid. An interval that ends there is wider.
  [[nodiscard]] static double largest_effect() noexcept;

 private:
  // What the two conditions have in common besides s, and what each has by itself.
  struct Shared {
    double bias = 0.0;
    double lapse = 0.0;
  };
  [[nodiscard]] Parameters parameters_at(double ln_s, const Shared& shared, double slope) const;
  /// Likelihood of one person's counts for each s and each bias and lapse rate, times a constant.
  [[nodiscard]] std::vector<double> likelihood_of(const std::vector<Count>& counts) const;
  /// L(ln s off, change) of one person.
  [[nodiscard]] std::vector<double> table_of(const PairedCounts& person) const;

  PsychometricFunction function_;
  std::vector<double> log_counted_;  // ln P(counted), for each s, bias and lapse rate, slope and level
  std::vector<double> log_other_;
  std::vector<Shared> shared_;
  std::vector<double> shared_weights_;  // prior
  GridAxis slopes_;                     // of a detection; of a comparison one value, unused
  std::size_t levels_ = 0;
  std::size_t spreads_ = 0;  // number of values of ln s with noise, in steps of kStep
  std::size_t bases_ = 0;    // number of values of ln s without noise, in steps of 4 kStep
  double first_base_ = 0.0;  // ln s
};

}  // namespace palpate::psychophysics
