#include "study/psychophysics/weighted.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate::psychophysics {
namespace {

// Values in ascending order, weights with the sum 1.
double quantile_of(const std::vector<Weighted>& sorted, double probability) {
  double below = 0.0;
  double last_middle = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double middle = below + 0.5 * sorted[i].weight;
    if (middle >= probability) {
      if (i == 0) return sorted[0].value;
      const double before = sorted[i - 1].value;
      return before + (sorted[i].value - before) * (probability - last_middle) / (middle - last_middle);
    }
    below += sorted[i].weight;
    last_middle = middle;
  }
  return sorted.back().value;
}

}  // namespace

Estimate estimate_of(std::vector<Weighted> values) {
  std::stable_sort(values.begin(), values.end(),
                   [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  std::vector<Weighted> merged;  // equal values as one
  double sum = 0.0;
  for (const Weighted& one : values) {
    sum += one.weight;
    if (!merged.empty() && merged.back().value == one.value) {
      merged.back().weight += one.weight;
    } else {
      merged.push_back(one);
    }
  }
  Estimate found;
  for (Weighted& one : merged) {
    one.weight /= sum;
    found.mean += one.weight * one.value;
  }
  double variance = 0.0;
  for (const Weighted& one : merged) {
    variance += one.weight * (one.value - found.mean) * (one.value - found.mean);
  }
  found.sd = std::sqrt(variance);
  found.low = quantile_of(merged, 0.025);
  found.high = quantile_of(merged, 0.975);
  return found;
}

}  // namespace palpate::psychophysics
