#pragma once
#include <vector>

#include "palpate/fit/ball_surface.h"
#include "palpate/fit/deformation.h"
#include "palpate/model/tissue.h"

namespace palpate::fit {

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
  std::vector<bool> at_limit;  // c, a, s, g: whether the best lies at a bound of the search, so that the data
                               // do not determine it
};

/// [setup] Least squares of u(r)/D over c, a, s and g, each sample counting the same however many places and
/// millimetres it has; from several starts, by Ceres in one thread: the same data give the same bits.
/// @throws InputError when there is no sample, or one without depth or radius.
[[nodiscard]] ReachFit fit_reach(const std::vector<ReachSample>& samples, const SurfaceRule& rule = {});

}  // namespace palpate::fit
