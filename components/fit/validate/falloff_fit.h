#pragma once
#include <vector>

#include "palpate/tissue.h"
#include "palpate/validate.h"

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

}  // namespace palpate::validate
