#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/validation.h"
#include "science/fit/image_compare.h"
#include "science/fit/image_file.h"
#include "science/fit/image_measure.h"
#include "science/fit/reach_fit.h"
#include "science/fit/rivals.h"
#include "science/fit/zeros_fit.h"

namespace palpate::fit {

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

/// A deformation that was measured in two photographs, and the model's.
struct ImageSet {
  Picture before;
  Picture after;
  ImageMeasurement measured;
  ImageSettings settings;
  DeformationComparison comparison;
  bool depth_fitted = false;        // the depth is the one that suits the line best
  double within_uncertainty = 0.0;  // share of points where the model lies within what the picture is
                                    // uncertain by
};

/// Everything that `palpate validate` found.
struct Validation {
  Law law;
  std::vector<ForceSet> forces;
  std::vector<ProfileSet> profiles;
  std::optional<ReachFit> reach;    // fitted to the profiles, which then are compared with it
  std::optional<ImageSet> image;    // its comparison is the last of the profiles
  std::vector<std::string> missed;  // goals, in words
};

/// [setup] A force curve beside the law, with the zeros that were given and with those that fit best.
/// @param fitted which of the two becomes `ours` @throws InputError, ParameterError as fit_zeros().
[[nodiscard]] ForceSet compare_forces(const Specimen& specimen, const Law& law, const Zeros& given,
                                      bool fitted);

/// [setup] Adds the profiles beside the law's surface to `validation`.
/// @param depths one a profile [m]; 0: the profile's own @param tip_radius R [m]
/// @param fit_first the law's reach is first fitted to the profiles together
/// @throws InputError as compare_deformation() and fit_reach().
void compare_profiles(const std::vector<Deformation>& profiles, const std::vector<double>& depths,
                      double tip_radius, bool fit_first, Validation& validation,
                      const SurfaceRule& rule = {});

/// [setup] Measures two photographs and compares with the tissue's u(r).
/// @param depth D [m]; 0: the largest u, or, where the tool hides it, the depth that suits the line best
/// @param tip_radius R [m] @throws InputError as read_picture() and measure_pictures().
[[nodiscard]] ImageSet compare_photographs(const std::filesystem::path& before,
                                           const std::filesystem::path& after, const ImageSettings& settings,
                                           const Law& law, double depth, double tip_radius);

/// [setup] Fits the laws of others to every data set of `validation` and measures what one evaluation of
/// each, and of ours, costs in processor time.
void compare_with_rivals(const std::vector<RivalKind>& kinds, Validation& validation);

}  // namespace palpate::fit
