#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "palpate/tissue.h"
#include "palpate/validate.h"
#include "science/imaging/image_file.h"
#include "science/imaging/image_measure.h"
#include "science/validate/validation_sets.h"

namespace palpate::imaging {

/// A deformation that was measured in two photographs, and the model's.
struct ImageSet {
  Picture before;
  Picture after;
  ImageMeasurement measured;
  ImageSettings settings;
  validate::DeformationComparison comparison;
  bool depth_fitted = false;        // the depth is the one that suits the line best
  double within_uncertainty = 0.0;  // share of points where the model lies within what the picture is
                                    // uncertain by
};

/// What `palpate validate` found, with photographs.
struct Validation : validate::Validation {
  std::optional<ImageSet> image;  // its comparison is the last of the profiles
};

/// [setup] The measured points as a deformation, both sides together by rising r; its depth is the largest u
/// where the deepest place is seen, else 0.
[[nodiscard]] validate::Deformation deformation_of(const ImageMeasurement& measured, const std::string& name);

/// [setup] The depth D [m] with which model.md's u(r) comes nearest to a deformation, least squares; for
/// pictures in which the tool hides the deepest place. Between the largest u and ten times that.
[[nodiscard]] double nearest_depth(const validate::Deformation& deformation,
                                   const model::ReachParameters& reach, double tip_radius);

/// [setup] Measures two photographs and compares with the tissue's u(r).
/// @param depth D [m]; 0: the largest u, or, where the tool hides it, the depth that suits the line best
/// @param tip_radius R [m] @throws InputError as read_picture() and measure_pictures().
[[nodiscard]] ImageSet compare_photographs(const std::filesystem::path& before,
                                           const std::filesystem::path& after, const ImageSettings& settings,
                                           const validate::Law& law, double depth, double tip_radius);

}  // namespace palpate::imaging
