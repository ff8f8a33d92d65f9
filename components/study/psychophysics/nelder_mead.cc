#include "study/psychophysics/nelder_mead.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace palpate::psychophysics {
namespace {

using Cost = std::function<double(const std::vector<double>&)>;

// centre + factor (point - centre)
std::vector<double> moved(const std::vector<double>& centre, const std::vector<double>& point,
                          double factor) {
  std::vector<double> result = centre;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += factor * (point[i] - centre[i]);
  return result;
}

// Replaces the worst vertex, or shrinks the simplex. Vertices are in ascending order of cost.
void step_simplex(const Cost& cost, std::vector<Minimum>& simplex) {
  const std::size_t last = simplex.size() - 1;
  std::vector<double> centre(last, 0.0);
  for (std::size_t i = 0; i < last; ++i) {
    for (std::size_t j = 0; j < last; ++j) centre[j] += simplex[i].at[j] / static_cast<double>(last);
  }
  const auto tried = [&](double factor) {
    Minimum one{moved(centre, simplex[last].at, factor), 0.0};
    one.value = cost(one.at);
    return one;
  };
  Minimum reflected = tried(-1.0);
  if (reflected.value < simplex[0].value) {
    Minimum expanded = tried(-2.0);
    simplex[last] = expanded.value < reflected.value ? std::move(expanded) : std::move(reflected);
    return;
  }
  if (reflected.value < simplex[last - 1].value) {
    simplex[last] = std::move(reflected);
    return;
  }
  Minimum contracted = tried(reflected.value < simplex[last].value ? -0.5 : 0.5);
  if (contracted.value < std::min(reflected.value, simplex[last].value)) {
    simplex[last] = std::move(contracted);
    return;
  }
  for (std::size_t i = 1; i <= last; ++i) {
    simplex[i].at = moved(simplex[0].at, simplex[i].at, 0.5);
    simplex[i].value = cost(simplex[i].at);
  }
}

Minimum search(const Cost& cost, const std::vector<double>& start, const std::vector<double>& steps,
               double tolerance) {
  constexpr int kMaxSteps = 2000;
  std::vector<Minimum> simplex{{start, cost(start)}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    std::vector<double> vertex = start;
    vertex[i] += steps[i];
    const double value = cost(vertex);
    simplex.push_back({std::move(vertex), value});
  }
  const auto by_cost = [](const Minimum& a, const Minimum& b) { return a.value < b.value; };
  for (int i = 0; i < kMaxSteps; ++i) {
    std::stable_sort(simplex.begin(), simplex.end(), by_cost);
    if (simplex.back().value - simplex.front().value <= tolerance) break;
    step_simplex(cost, simplex);
  }
  return *std::min_element(simplex.begin(), simplex.end(), by_cost);
}

}  // namespace

Minimum minimize(const Cost& cost, const std::vector<double>& start, const std::vector<double>& steps,
                 double tolerance) {
  const Minimum first = search(cost, start, steps, tolerance);
  return search(cost, first.at, steps, tolerance);
}

}  // namespace palpate::psychophysics
