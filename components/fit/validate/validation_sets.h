#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/tissue.h"
#include "palpate/validate.h"

#include "fit/validate/baselines.h"

namespace palpate::validate {

/// A displacement profile and its tool. SI units.
struct ProfileSample {
  Deformation deformation;
  double depth = 0.0;       // D [m] > 0
  double tip_radius = 0.0;  // R [m] > 0
};

/// Falloff ratios of the displacement profile that fit all samples together.
struct FalloffFit {
  model::FalloffRatios reach;
  std::vector<double> nrmse;   // RMS error divided by the depth, one per sample
  std::vector<bool> at_limit;  // c, a, s, g, p: the optimum lies at a bound of the search, so the data do not
                               // determine this parameter
  bool exponent_kept = false;  // p was not fitted, because the samples are too similar to determine it
};

/// Smallest ratio between D/R of the deepest and of the shallowest sample for which p is fitted. At a single
/// depth c has the same effect as p; at two similar depths p amplifies an error of u many times.
inline constexpr double kLeastSpreadOfDepths = 1.2;

/// [setup] Least-squares fit of u(r)/D over c, a, s, g and p. All samples have the same weight, whatever
/// their number of points and depth. Several starts, Ceres in one thread: the same data give the same bits.
/// @param exponent value of p where the samples do not determine it (kLeastSpreadOfDepths)
/// @throws InputError when there is no sample, or one without depth or radius.
[[nodiscard]] FalloffFit fit_falloff(const std::vector<ProfileSample>& samples, const SurfaceRule& rule = {},
                                     double exponent = model::FalloffRatios{}.depth_exponent);

/// The zeros with which a measurement fits a tissue best.
struct ZerosFit {
  Zeros zeros;
  bool at_limit = false;  // the optimum lies at a bound of the search: displacements do not start near first
                          // contact
};

/// [setup] Fits first contact and sensor offset of a measurement to a fixed tissue, with the bounds, loss and
/// priors that `palpate fit` uses for these two. One thread: the same data give the same bits.
/// @throws InputError when displacement or force is constant; ParameterError as the laws do.
[[nodiscard]] ZerosFit fit_zeros(const identify::Specimen& specimen, const Law& law);

/// Errors of a law with one pair of zeros.
struct ZeroedErrors {
  Zeros zeros;
  Errors errors;
  bool at_limit = false;  // as ZerosFit::at_limit; false for given zeros
};

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
