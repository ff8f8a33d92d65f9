#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/validate.h"

namespace palpate::validate {

/// Baseline models, for comparison.
enum class BaselineKind {
  kHertz,        // F = a d^1.5; surface of a half-space around a ball with a fitted contact radius
  kLinear,       // F = a d; profile: a cone
  kExponential,  // F = a (e^(b d) - 1); profile: u = D e^(-r/b)
  kMassSpring,   // MassSpringPatch with its two stiffnesses fitted (profile: their ratio)
};

/// [any] "hertz", "linear", "exponential", "mass-spring".
[[nodiscard]] const char* to_string(BaselineKind kind) noexcept;
/// [setup] Parses a comma-separated list of kinds, each once. @throws InputError that names the invalid one
/// and all valid ones.
[[nodiscard]] std::vector<BaselineKind> parse_baselines(std::string_view text);

/// A baseline model fitted to one data set by least squares.
struct BaselineFit {
  BaselineKind kind = BaselineKind::kHertz;
  std::string parameters;                  // formatted for output
  Errors errors;                           // on the same scale as those of the law
  std::vector<double> computed;            // N, or m for a profile
  std::function<double(double)> evaluate;  // force [N] at a depth [m], or u [m] at r [m]; not empty; for a
                                           // mass-spring patch one relaxation of all nodes
};

/// [setup] Fits the compared force curve: depths and forces with the zeros subtracted. Baseline models have
/// no relaxation.
[[nodiscard]] BaselineFit fit_force_baseline(BaselineKind kind, const ForceComparison& comparison);

/// [setup] Fits the compared profile; the depth is given.
[[nodiscard]] BaselineFit fit_profile_baseline(BaselineKind kind, const DeformationComparison& comparison);

}  // namespace palpate::validate
