#include "fit/validate/baselines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <utility>

#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::validate {
namespace {

using Function = std::function<double(double)>;

constexpr std::array<std::pair<const char*, BaselineKind>, 4> kRivals = {
    {{"hertz", BaselineKind::kHertz},
     {"linear", BaselineKind::kLinear},
     {"exponential", BaselineKind::kExponential},
     {"mass-spring", BaselineKind::kMassSpring}}};

/// Minimises `cost` between two logarithms by a coarse search and golden sections. @return the argument, not
/// its logarithm
double least_of(const Function& cost, double low, double high) {
  constexpr int kCoarse = 16;
  const auto at = [&](int i) { return std::log(low) + (std::log(high) - std::log(low)) * i / kCoarse; };
  int best = 0;
  double best_cost = cost(low);
  for (int i = 1; i <= kCoarse; ++i) {
    const double here = cost(std::exp(at(i)));
    if (here < best_cost) {
      best = i;
      best_cost = here;
    }
  }
  double from = at(std::max(0, best - 1));
  double to = at(std::min(kCoarse, best + 1));
  constexpr double kGolden = 1.0 / std::numbers::phi;
  for (int n = 0; n < 24; ++n) {
    const double first = to - kGolden * (to - from);
    const double second = from + kGolden * (to - from);
    if (cost(std::exp(first)) < cost(std::exp(second))) {
      to = second;
    } else {
      from = first;
    }
  }
  return std::exp(0.5 * (from + to));
}

/// The factor of `shape` that best fits `values`, and the remaining error.
struct Scaled {
  double factor = 0.0;
  double squares = 0.0;
};
Scaled scaled(const std::vector<double>& shape, const std::vector<double>& values) {
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    product += shape[i] * values[i];
    square += shape[i] * shape[i];
  }
  Scaled result;
  result.factor = square > 0.0 ? product / square : 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const double error = result.factor * shape[i] - values[i];
    result.squares += error * error;
  }
  return result;
}

std::vector<double> mapped(const std::vector<double>& places, const Function& function) {
  std::vector<double> values;
  for (const double place : places) values.push_back(function(place));
  return values;
}

std::string worded(const char* format, double first, double second = 0.0) {
  char text[96];
  std::snprintf(text, sizeof text, format, first, second);
  return text;
}

/// Table of force / home stiffness at depths from 0 to `deepest`, for a stiffness ratio.
std::vector<double> patch_table(double ratio, double deepest) {
  constexpr int kDepths = 24;
  MassSpringPatch patch(ratio);
  std::vector<double> table;
  for (int i = 0; i <= kDepths; ++i) table.push_back(patch.press(deepest * i / kDepths));
  return table;
}

double in_table(const std::vector<double>& table, double deepest, double depth) {
  const double place = std::clamp(depth / deepest, 0.0, 1.0) * static_cast<double>(table.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), table.size() - 2);
  const double share = place - static_cast<double>(low);
  return (1.0 - share) * table[low] + share * table[low + 1];
}

/// Depths > 0 and forces of a comparison, with the zeros subtracted.
struct ForceCurve {
  std::vector<double> depth;
  std::vector<double> force;
  double deepest = 0.0;
};
ForceCurve measured_curve(const ForceComparison& comparison) {
  ForceCurve curve;
  for (std::size_t i = 0; i < comparison.measured.size(); ++i) {
    curve.depth.push_back(
        std::max(0.0, comparison.measured.displacement[i] - comparison.zeros.first_contact));
    curve.force.push_back(comparison.measured.force[i] - comparison.zeros.force);
    curve.deepest = std::max(curve.deepest, curve.depth.back());
  }
  return curve;
}

BaselineFit scaled_force(BaselineKind kind, const ForceCurve& curve, const Function& shape,
                         const char* text) {
  const double factor = scaled(mapped(curve.depth, shape), curve.force).factor;
  BaselineFit fit;
  fit.kind = kind;
  fit.parameters = worded(text, factor);
  fit.evaluate = [factor, shape](double depth) { return factor * shape(depth); };
  fit.computed = mapped(curve.depth, fit.evaluate);
  return fit;
}

BaselineFit exponential_force(const ForceCurve& curve) {
  const auto shape = [](double b) { return [b](double depth) { return std::expm1(b * depth); }; };
  const double b =
      least_of([&](double tried) { return scaled(mapped(curve.depth, shape(tried)), curve.force).squares; },
               1e-3 / curve.deepest, 50.0 / curve.deepest);
  BaselineFit fit = scaled_force(BaselineKind::kExponential, curve, shape(b), "");
  const double a = scaled(mapped(curve.depth, shape(b)), curve.force).factor;
  fit.parameters = worded("a = %.4g N, b = %.4g 1/m", a, b);
  return fit;
}

BaselineFit mass_spring_force(const ForceCurve& curve) {
  const auto shape = [&](const std::vector<double>& table) {
    return [&table, &curve](double depth) { return in_table(table, curve.deepest, depth); };
  };
  const double ratio = least_of(
      [&](double tried) {
        const std::vector<double> table = patch_table(tried, curve.deepest);
        return scaled(mapped(curve.depth, shape(table)), curve.force).squares;
      },
      1e-3, 1e4);
  const std::vector<double> table = patch_table(ratio, curve.deepest);
  BaselineFit fit = scaled_force(BaselineKind::kMassSpring, curve, shape(table), "");
  const double home = scaled(mapped(curve.depth, shape(table)), curve.force).factor;
  fit.parameters = worded("home spring %.4g N/m, others %.4g N/m", home, home * ratio);
  fit.evaluate = [home, patch = std::make_shared<MassSpringPatch>(ratio)](double depth) {
    return home * patch->press(depth);
  };
  return fit;
}

Function profile_shape(BaselineKind kind, double depth, double width) {
  switch (kind) {
    case BaselineKind::kHertz:
      return [=](double r) { return hertz_displacement(depth, width, r); };
    case BaselineKind::kLinear:
      return [=](double r) { return depth * std::max(0.0, 1.0 - r / width); };
    case BaselineKind::kExponential:
      return [=](double r) { return depth * std::exp(-r / width); };
    case BaselineKind::kMassSpring:
      break;
  }
  constexpr int kSteps = 10;  // steps to the depth, so that the relaxation converges
  auto patch = std::make_shared<MassSpringPatch>(width);
  for (int i = 1; i <= kSteps; ++i) patch->press(depth * i / kSteps);
  return [patch](double r) { return patch->at(r); };
}

}  // namespace

double hertz_displacement(double depth, double contact_radius, double r) noexcept {
  const double x = r / contact_radius;
  if (x <= 1.0) return depth * (1.0 - 0.5 * x * x);
  return depth / std::numbers::pi * ((2.0 - x * x) * std::asin(1.0 / x) + std::sqrt(x * x - 1.0));
}

const char* to_string(BaselineKind kind) noexcept {
  for (const auto& [name, known] : kRivals) {
    if (known == kind) return name;
  }
  return "";
}

std::vector<BaselineKind> parse_baselines(std::string_view text) {
  std::vector<BaselineKind> kinds;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    const std::string_view word = text.substr(0, comma);
    const auto* const known = std::find_if(kRivals.begin(), kRivals.end(),
                                           [word](const auto& baseline) { return baseline.first == word; });
    if (known == kRivals.end()) {
      throw InputError("--against " + std::string(word) +
                       ": must be hertz, linear, exponential or mass-spring, several between commas");
    }
    if (std::find(kinds.begin(), kinds.end(), known->second) == kinds.end()) kinds.push_back(known->second);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
  }
  return kinds;
}

BaselineFit fit_force_baseline(BaselineKind kind, const ForceComparison& comparison) {
  const ForceCurve curve = measured_curve(comparison);
  BaselineFit fit;
  if (!(curve.deepest > 0.0)) {
    throw InputError(comparison.measured.name + ": no point is deeper than the first contact");
  }
  switch (kind) {
    case BaselineKind::kHertz:
      fit = scaled_force(
          kind, curve, [](double depth) { return depth * std::sqrt(depth); }, "a = %.4g N/m^1.5");
      break;
    case BaselineKind::kLinear:
      fit = scaled_force(
          kind, curve, [](double depth) { return depth; }, "a = %.4g N/m");
      break;
    case BaselineKind::kExponential:
      fit = exponential_force(curve);
      break;
    case BaselineKind::kMassSpring:
      fit = mass_spring_force(curve);
      break;
  }
  for (double& force : fit.computed) force += comparison.zeros.force;
  fit.errors = errors_of(comparison.measured.force, fit.computed, comparison.errors.scale);
  return fit;
}

BaselineFit fit_profile_baseline(BaselineKind kind, const DeformationComparison& comparison) {
  const Deformation& measured = comparison.measured;
  const auto cost = [&](double width) {
    const std::vector<double> computed =
        mapped(measured.distance, profile_shape(kind, comparison.depth, width));
    return errors_of(measured.displacement, computed, 1.0).rms;
  };
  const bool patch = kind == BaselineKind::kMassSpring;
  const double width = patch
                           ? least_of(cost, 1e-3, 1e4)
                           : least_of(cost, 1e-3 * measured.distance.back(), 10.0 * measured.distance.back());
  BaselineFit fit;
  fit.kind = kind;
  fit.parameters = patch ? worded("springs %.4g times the home springs", width)
                         : worded("width %.4g mm", width / kMillimetre);
  fit.computed = mapped(measured.distance, profile_shape(kind, comparison.depth, width));
  fit.errors = errors_of(measured.displacement, fit.computed, comparison.depth);
  if (patch) {
    fit.evaluate = [depth = comparison.depth, patch_at = std::make_shared<MassSpringPatch>(width)](double r) {
      patch_at->press(depth);
      return patch_at->at(r);
    };
  } else {
    fit.evaluate = profile_shape(kind, comparison.depth, width);
  }
  return fit;
}

MassSpringPatch::MassSpringPatch(double ratio) : ratio_(ratio), down_(kSide * kSide, 0.0) {}

MassSpringPatch::Pull MassSpringPatch::pull_of_neighbours(std::size_t row,
                                                          std::size_t column) const noexcept {
  Pull pull;
  const double here = down_[row * kSide + column];
  for (std::size_t r = row - 1; r <= row + 1; ++r) {
    for (std::size_t c = column - 1; c <= column + 1; ++c) {
      if (r == row && c == column) continue;
      const double there = down_[r * kSide + c];
      const double rest = r == row || c == column ? kSpacing : std::numbers::sqrt2 * kSpacing;
      const double length = std::sqrt(rest * rest + (there - here) * (there - here));
      const double rise = there - here;
      pull.force += ratio_ * (1.0 - rest / length) * rise;
      pull.stiffness += ratio_ * (1.0 - rest / length + rest * rise * rise / (length * length * length));
    }
  }
  return pull;
}

double MassSpringPatch::press(double depth) noexcept {
  node(kMiddle, kMiddle) = depth;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t row = 1; row + 1 < kSide; ++row) {
      for (std::size_t column = 1; column + 1 < kSide; ++column) {
        if (row == kMiddle && column == kMiddle) continue;
        const Pull pull = pull_of_neighbours(row, column);
        double& here = node(row, column);
        here += (pull.force - here) / (pull.stiffness + 1.0);  // Newton step for this node
      }
    }
  }
  return depth - pull_of_neighbours(kMiddle, kMiddle).force;
}

double MassSpringPatch::at(double r) const noexcept {
  const double place = r / kSpacing;
  if (!(place < static_cast<double>(kSide - 1 - kMiddle))) return 0.0;
  const auto low = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(low);
  const double* const row = down_.data() + kMiddle * kSide + kMiddle;
  return (1.0 - share) * row[low] + share * row[low + 1];
}

}  // namespace palpate::validate
