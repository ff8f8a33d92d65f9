#include <algorithm>
#include <numeric>

#include "palpate/identify.h"

namespace palpate::identify {
namespace {

/// The points sorted by displacement.
Specimen by_displacement(const Specimen& specimen) {
  std::vector<std::size_t> order(specimen.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&specimen](std::size_t a, std::size_t b) {
    return specimen.displacement[a] < specimen.displacement[b];
  });
  Specimen sorted;
  sorted.name = specimen.name;
  for (const std::size_t i : order) {
    sorted.displacement.push_back(specimen.displacement[i]);
    sorted.force.push_back(specimen.force[i]);
  }
  return sorted;
}

/// Means of `block` neighbours each.
std::vector<double> means(const std::vector<double>& values, std::size_t block) {
  std::vector<double> out;
  for (std::size_t begin = 0; begin < values.size(); begin += block) {
    const std::size_t end = std::min(begin + block, values.size());
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += values[i] - values[begin];
    out.push_back(values[begin] + sum / static_cast<double>(end - begin));
  }
  return out;
}

}  // namespace

Specimen thinned(const Specimen& specimen, std::size_t most) {
  if (specimen.size() <= most) return specimen;
  const std::size_t block = (specimen.size() + most - 1) / most;
  const Specimen ordered = specimen.time.empty() ? by_displacement(specimen) : specimen;
  return {specimen.name, means(ordered.time, block), means(ordered.displacement, block),
          means(ordered.force, block)};
}

}  // namespace palpate::identify
