#pragma once
#include <vector>

#include "palpate/tissue.h"
#include "palpate/validate.h"

namespace palpate::validate {

/// A deformation and the tool that made it. SI.
struct ReachSample {
  Deformation deformation;
  double depth = 0.0;       // D [m] > 0
  double tip_radius = 0.0;  // R [m] > 0
};

/// The reach that is best for some deformations together.
struct ReachFit {
  model::ReachParameters reach;
  std::vector<double> nrmse;   // RMS error over the depth, one a sample
  std::vector<bool> at_limit;  // c, a, s, g, p: whether the best lies at a bound of the search, so that the
                               // data do not determine it
  bool exponent_kept = false;  // p is as it was given, because the samples are too alike to determine it
};

/// D/R of the deepest sample must be this many times that of the shallowest, or p is kept: at one depth c
/// does all that p could, and at two that are near it an error of u moves p by many times as much.
inline constexpr double kLeastSpreadOfDepths = 1.2;

/// [setup] Least squares of u(r)/D over c, a, s, g and p, each sample counting the same however many places
/// and millimetres it has; from several starts, by Ceres in one thread: the same data give the same bits.
/// @param exponent p where the samples do not determine it (kLeastSpreadOfDepths)
/// @throws InputError when there is no sample, or one without depth or radius.
[[nodiscard]] ReachFit fit_reach(const std::vector<ReachSample>& samples, const SurfaceRule& rule = {},
                                 double exponent = model::ReachParameters{}.depth_exponent);

}  // namespace palpate::validate
