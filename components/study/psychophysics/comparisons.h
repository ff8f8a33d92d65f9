#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// Student's t test of a mean of 0, with its 95 % interval.
struct PairedTest {
  double mean = 0.0;
  double low = 0.0;
  double high = 0.0;
  double t = 0.0;
  double two_sided = 1.0;  // p values
  double greater = 0.5;    // one-sided, of a mean above 0
};

/// [setup] Paired t test. @param differences one for each person
/// @throws ParameterError for fewer than two people
[[nodiscard]] PairedTest paired_t(std::span<const double> differences);

/// [setup] Adjusted p values of several tests, in their order [Holm 1979].
[[nodiscard]] std::vector<double> holm(std::span<const double> p_values);

/// Rise and fall of the sensitivity with the noise. Both contrasts are chosen before the data are seen.
struct InvertedU {
  PairedTest rise;  // middle levels less the first level
  PairedTest fall;  // middle levels less the last level
  /// Whether both one-sided tests reject at 5 % (intersection-union test).
  [[nodiscard]] bool found() const noexcept { return rise.greater <= 0.05 && fall.greater <= 0.05; }
};

/// [setup] @param d_primes for each person, the d' at each level of the noise @param middle indices of the
/// levels between the first and the last whose mean is compared
/// @throws ParameterError for a person with another number of levels, or an index out of range
[[nodiscard]] InvertedU inverted_u(std::span<const std::vector<double>> d_primes,
                                   std::span<const std::size_t> middle);

/// [setup] Orders of the conditions 0 to n - 1, one row for each person in turn: n rows for an even n, 2 n
/// for an odd n. Each condition is equally often at each position, and equally often after each of the rest
/// [Williams 1949]. @throws ParameterError unless n >= 1
[[nodiscard]] std::vector<std::vector<int>> williams_square(int conditions);

}  // namespace palpate::psychophysics
