#include "study/psychophysics/comparisons.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/statistics.h"
#include "palpate/error.h"

#include "study/psychophysics/normal.h"

namespace palpate::psychophysics {

PairedTest paired_t(std::span<const double> differences) {
  const auto people = static_cast<double>(differences.size());
  if (people < 2.0) throw ParameterError("people", people, ">= 2");
  PairedTest test;
  test.mean = mean(differences);
  const double error = standard_deviation(differences) / std::sqrt(people);
  const double range = student_t_quantile(people - 1.0) * error;
  test.low = test.mean - range;
  test.high = test.mean + range;
  if (test.mean != 0.0) test.t = test.mean / error;
  test.two_sided = std::isinf(test.t) ? 0.0 : student_t_two_sided(test.t, people - 1.0);
  test.greater = test.t > 0.0 ? 0.5 * test.two_sided : 1.0 - 0.5 * test.two_sided;
  return test;
}

std::vector<double> holm(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto remaining = static_cast<double>(order.size() - i);
    largest = std::max(largest, std::min(1.0, remaining * p_values[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

InvertedU inverted_u(std::span<const std::vector<double>> d_primes, std::span<const std::size_t> middle) {
  if (middle.empty()) throw ParameterError("middle", 0.0, "at least one level");
  std::vector<double> rise;
  std::vector<double> fall;
  for (const std::vector<double>& levels : d_primes) {
    if (levels.size() != d_primes.front().size()) {
      throw ParameterError("levels", static_cast<double>(levels.size()), "equal for all people");
    }
    double sum = 0.0;
    for (const std::size_t level : middle) {
      if (level == 0 || level + 1 >= levels.size()) {
        throw ParameterError("middle", static_cast<double>(level), "between the first and the last level");
      }
      sum += levels[level];
    }
    const double centre = sum / static_cast<double>(middle.size());
    rise.push_back(centre - levels.front());
    fall.push_back(centre - levels.back());
  }
  return {paired_t(rise), paired_t(fall)};
}

std::vector<std::vector<int>> williams_square(int conditions) {
  if (conditions < 1) throw ParameterError("conditions", conditions, ">= 1");
  std::vector<int> first;  // 0, n - 1, 1, n - 2, 2, ...: successive differences are all different
  for (int i = 0; i < conditions; ++i) first.push_back(i % 2 == 0 ? i / 2 : conditions - 1 - i / 2);
  std::vector<std::vector<int>> rows;
  for (int shift = 0; shift < conditions; ++shift) {
    std::vector<int> row;
    for (const int condition : first) row.push_back((condition + shift) % conditions);
    rows.push_back(row);
  }
  if (conditions % 2 == 1 && conditions > 1) {  // the differences occur with one sign only
    for (int i = 0; i < conditions; ++i) {
      rows.emplace_back(rows[static_cast<std::size_t>(i)].rbegin(), rows[static_cast<std::size_t>(i)].rend());
    }
  }
  return rows;
}

}  // namespace palpate::psychophysics
