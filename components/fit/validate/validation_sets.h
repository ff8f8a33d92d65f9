#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/validate.h"

#include "fit/validate/baselines.h"
#include "fit/validate/falloff_fit.h"
#include "fit/validate/zeros_fit.h"

namespace palpate::validate {

/// A baseline model on the same data.
struct BaselineResult {
  BaselineFit fit;
  double cost_ns = 0.0;  // CPU time of one evaluation
};

/// A measured force curve with the results of the law and of the baseline models.
struct ForceSet {
  ForceComparison ours;
  bool zeros_fitted = false;  // whether `ours` uses the fitted zeros instead of the given ones
  ZeroedErrors given;         // errors with the given zeros
  ZeroedErrors fitted;        // errors with the fitted zeros
  double cost_ns = 0.0;
  std::vector<BaselineResult> baselines;
};

/// A measured displacement profile with the results of the model and of the baseline models.
struct ProfileSet {
  DeformationComparison ours;
  double cost_ns = 0.0;
  std::vector<BaselineResult> baselines;
};

/// All results of `palpate validate`.
struct Validation {
  Law law;
  std::vector<ForceSet> forces;
  std::vector<ProfileSet> profiles;
  std::optional<FalloffFit> reach;  // fitted to the profiles, which are then compared with it
  std::vector<std::string> missed;  // goals that were missed, one sentence each
};

/// [setup] Compares a force curve with the law, with the given and with fitted zeros.
/// @param fitted which of the two becomes `ours` @throws InputError, ParameterError as fit_zeros().
[[nodiscard]] ForceSet compare_forces(const identify::Specimen& specimen, const Law& law, const Zeros& given,
                                      bool fitted);

/// [setup] Compares profiles with the law's surface and adds them to `validation`.
/// @param depths one per profile [m]; 0: the profile's own @param tip_radius R [m]
/// @param fit_first first fit the falloff ratios to all profiles @throws InputError as compare_deformation()
/// and fit_falloff().
void compare_profiles(const std::vector<Deformation>& profiles, const std::vector<double>& depths,
                      double tip_radius, bool fit_first, Validation& validation,
                      const SurfaceRule& rule = {});

/// [setup] Fits the baseline models to each data set of `validation` and measures the CPU time of one
/// evaluation of each, and of the law.
void compare_with_baselines(const std::vector<BaselineKind>& kinds, Validation& validation);

}  // namespace palpate::validate
