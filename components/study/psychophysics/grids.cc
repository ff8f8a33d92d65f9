#include <cmath>

#include "core/base/portable_math.h"
#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

const GridAxis kLapses = {{0.0, 0.02, 0.05, 0.10, 0.15}, {0.35, 0.30, 0.20, 0.10, 0.05}};
constexpr double kLogOf10 = 2.30258509299404568402;

// Values from `first` in equal steps to `last` with a normal prior.
GridAxis normal_axis(double first, double last, double step, double mean, double sd) {
  GridAxis axis;
  const int steps = static_cast<int>(std::lround((last - first) / step));
  for (int i = 0; i <= steps; ++i) {
    const double value = first + (last - first) * i / steps;
    const double z = (value - mean) / sd;
    axis.values.push_back(value);
    axis.weights.push_back(portable::exp(-0.5 * z * z));
  }
  return axis;
}

}  // namespace

QuestPlusGrid detection_grid(double from, double to, int per_decade) {
  if (!(from > 0.0 && std::isfinite(from))) throw ParameterError("from", from, "finite and > 0");
  if (!(to > from && std::isfinite(to))) throw ParameterError("to", to, "finite and above `from`");
  if (per_decade < 1) throw ParameterError("per_decade", per_decade, ">= 1");
  constexpr double kLocationStep = 0.025;  // decades
  constexpr double kPriorSd = 0.6;         // decades
  const double first = portable::log(from) / kLogOf10;
  const double last = portable::log(to) / kLogOf10;
  if (last - first < kLocationStep) throw ParameterError("to", to, "at least 6 % above `from`");
  constexpr double kMostDecades = 8.0;
  constexpr int kMostPerDecade = 100;
  if (last - first > kMostDecades) throw ParameterError("to", to, "at most 1e8 times `from`");
  if (per_decade > kMostPerDecade) throw ParameterError("per_decade", per_decade, "<= 100");
  QuestPlusGrid grid;
  const int steps = static_cast<int>(std::floor((last - first) * per_decade + 1e-6));
  for (int i = 0; i <= steps; ++i) grid.levels.push_back(first + static_cast<double>(i) / per_decade);
  grid.location = normal_axis(first, last, kLocationStep, 0.5 * (first + last), kPriorSd);
  grid.spread = {{1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0}};
  grid.lapse = kLapses;
  return grid;
}

QuestPlusGrid difference_grid(double least, double largest, int steps) {
  if (!(least > 1.0)) throw ParameterError("least", least, "> 1");
  if (!(largest > least && std::isfinite(largest))) {
    throw ParameterError("largest", largest, "finite and above `least`");
  }
  if (steps < 2) throw ParameterError("steps", steps, ">= 2");
  constexpr double kBias = 0.2;       // ln of a ratio
  constexpr double kBiasStep = 0.04;  // ln of a ratio
  constexpr double kBiasSd = 0.08;    // ln of a ratio
  // log10 of the standard deviation of ln of a ratio; the last is 0.
  constexpr double kFirstSpread = -1.7;
  constexpr double kSpreadStep = 0.05;
  constexpr double kMeanSpread = -0.7;  // a just noticeable difference of 14 %
  constexpr double kSpreadSd = 0.5;
  QuestPlusGrid grid;
  grid.function.shape = PsychometricFunction::Shape::kNormal;
  const double first = portable::log(portable::log(least));
  const double step = (portable::log(portable::log(largest)) - first) / (steps - 1);
  for (int i = steps - 1; i >= 0; --i) grid.levels.push_back(-portable::exp(first + step * i));
  for (int i = 0; i < steps; ++i) grid.levels.push_back(portable::exp(first + step * i));
  grid.location = normal_axis(-kBias, kBias, kBiasStep, 0.0, kBiasSd);
  grid.spread = normal_axis(kFirstSpread, 0.0, kSpreadStep, kMeanSpread, kSpreadSd);
  for (double& spread : grid.spread.values) spread = portable::exp(kLogOf10 * spread);
  grid.lapse = kLapses;
  return grid;
}

}  // namespace palpate::psychophysics
