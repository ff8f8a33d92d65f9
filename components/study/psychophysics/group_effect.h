#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// One person's answers "second" at each level of a comparison, without and with the noise.
struct PairedCounts {
  std::vector<Count> off, with;
};

/// Effect of the noise on the standard deviation s of the psychometric functions of a group.
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
/// N(Delta, td). Interval bias and lapse rate are the same with and without noise; they are summed over the
/// grid with its prior.
class GroupModel final {
 public:
  /// [setup] @param grid of a comparison, difference_grid(): its levels, biases, lapse rates and range of s
  /// @throws ParameterError for another shape of function
  explicit GroupModel(const QuestPlusGrid& grid);

  /// [setup] Largest likelihood and interval: twice the decrease of the logarithm of the profile likelihood
  /// is the square of the 97.5 % quantile of Student's t with N - 1 degrees of freedom.
  /// @throws ParameterError for fewer than two people or other numbers of counts than levels
  [[nodiscard]] GroupEffect fit(std::span<const PairedCounts> people) const;

  /// [any] Largest effect of the grid. An interval that ends there is wider.
  [[nodiscard]] static double largest_effect() noexcept;

 private:
  /// Likelihood of one person's counts for each s and each pair of bias and lapse rate, times a constant.
  [[nodiscard]] std::vector<double> likelihood_of(const std::vector<Count>& counts) const;
  /// L(ln s off, change) of one person.
  [[nodiscard]] std::vector<double> table_of(const PairedCounts& person) const;

  std::vector<double> log_second_;  // ln P("second"), for each s, pair and level
  std::vector<double> log_first_;
  std::vector<double> pair_weights_;  // prior of the pairs of bias and lapse rate
  std::size_t levels_ = 0;
  std::size_t spreads_ = 0;  // number of values of ln s with noise, in steps of kStep
  std::size_t bases_ = 0;    // number of values of ln s without noise, in steps of 4 kStep
  double first_base_ = 0.0;  // ln s
};

}  // namespace palpate::psychophysics
