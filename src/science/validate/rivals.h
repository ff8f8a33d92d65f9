#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/validate.h"

namespace palpate::validate {

/// Laws that others use, for comparison.
enum class RivalKind {
  kHertz,        // F = a d^1.5; the surface around a ball in a half-space, its contact radius fitted
  kLinear,       // F = a d; a cone
  kExponential,  // F = a (e^(b d) - 1); u = D e^(-r/b)
  kMassSpring,   // MassSpringPatch, its two stiffnesses fitted (of a profile: their ratio)
};

/// [any] "hertz", "linear", "exponential", "mass-spring".
[[nodiscard]] const char* to_string(RivalKind kind) noexcept;
/// [setup] The kinds named between commas, each once. @throws InputError naming the bad one and all there
/// are.
[[nodiscard]] std::vector<RivalKind> parse_rivals(std::string_view text);

/// A rival fitted to one data set by least squares of its own.
struct RivalFit {
  RivalKind kind = RivalKind::kHertz;
  std::string parameters;                  // in words
  Errors errors;                           // on the same scale as ours
  std::vector<double> computed;            // N, or m of a profile
  std::function<double(double)> evaluate;  // force [N] at a depth [m], or u [m] at r [m]; not empty; of a
                                           // mass-spring patch, one relaxation of all its nodes
};

/// [setup] Fits the force curve that was compared: its depths and forces with its zeros taken off. The rivals
/// know no relaxation.
[[nodiscard]] RivalFit fit_force_rival(RivalKind kind, const ForceComparison& comparison);

/// [setup] Fits the profile that was compared; the depth is given, as to ours.
[[nodiscard]] RivalFit fit_profile_rival(RivalKind kind, const DeformationComparison& comparison);

}  // namespace palpate::validate
