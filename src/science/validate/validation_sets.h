#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/validate.h"
#include "science/validate/reach_fit.h"
#include "science/validate/rivals.h"
#include "science/validate/zeros_fit.h"

namespace palpate::validate {

/// A law of others on the same data.
struct RivalResult {
  RivalFit fit;
  double cost_ns = 0.0;  // of one evaluation, processor time
};

/// One measured force curve, ours and the others'.
struct ForceSet {
  ForceComparison ours;
  bool zeros_fitted = false;  // whether ours is with the zeros that fit best, or with those that were given
  ZeroedErrors given;         // what ours leaves with the one
  ZeroedErrors fitted;        // and with the other
  double cost_ns = 0.0;
  std::vector<RivalResult> rivals;
};

/// One measured profile, ours and the others'.
struct ProfileSet {
  DeformationComparison ours;
  double cost_ns = 0.0;
  std::vector<RivalResult> rivals;
};

/// Everything that `palpate validate` found.
struct Validation {
  Law law;
  std::vector<ForceSet> forces;
  std::vector<ProfileSet> profiles;
  std::optional<ReachFit> reach;    // fitted to the profiles, which then are compared with it
  std::vector<std::string> missed;  // goals, in words
};

/// [setup] A force curve beside the law, with the zeros that were given and with those that fit best.
/// @param fitted which of the two becomes `ours` @throws InputError, ParameterError as fit_zeros().
[[nodiscard]] ForceSet compare_forces(const identify::Specimen& specimen, const Law& law, const Zeros& given,
                                      bool fitted);

/// [setup] Adds the profiles beside the law's surface to `validation`.
/// @param depths one a profile [m]; 0: the profile's own @param tip_radius R [m]
/// @param fit_first the law's reach is first fitted to the profiles together
/// @throws InputError as compare_deformation() and fit_reach().
void compare_profiles(const std::vector<Deformation>& profiles, const std::vector<double>& depths,
                      double tip_radius, bool fit_first, Validation& validation,
                      const SurfaceRule& rule = {});

/// [setup] Fits the laws of others to every data set of `validation` and measures what one evaluation of
/// each, and of ours, costs in processor time.
void compare_with_rivals(const std::vector<RivalKind>& kinds, Validation& validation);

}  // namespace palpate::validate
