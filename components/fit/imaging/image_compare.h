#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "palpate/tissue.h"
#include "palpate/validate.h"

#include "fit/imaging/image_file.h"
#include "fit/imaging/image_measure.h"
#include "fit/validate/validation_sets.h"

namespace palpate::imaging {

/// A displacement profile measured in two photographs, compared with the model's.
struct ImageSet {
  Picture before;
  Picture after;
  ImageMeasurement measured;
  ImageSettings settings;
  validate::DeformationComparison comparison;
  bool depth_fitted = false;        // the depth was fitted to the profile
  double within_uncertainty = 0.0;  // fraction of the points where the model is within the uncertainty of the
                                    // measurement
};

/// Results of `palpate validate`, with photographs.
struct Validation : validate::Validation {
  std::optional<ImageSet> image;  // its comparison is the last of the profiles
};

/// [setup] The measured points as a displacement profile, both sides merged by increasing r. Its depth is the
/// largest u when the deepest point is seen, else 0.
[[nodiscard]] validate::Deformation deformation_of(const ImageMeasurement& measured, const std::string& name);

/// Distance from the ball, in pixels, within which a visible place of the line bounds the depth: beside an
/// instrument the line is not detected in up to about so many columns.
inline constexpr double kPixelRange = 20.0;
/// Error of a place's r, in pixels: of the centre and of the ball's edge.
inline constexpr double kPixelError = 2.0;

/// [setup] Largest depth D [m] of a pressed ball that the line beside it allows. No part of the line lies
/// above the lower half of the ball, so D <= u(r) + R - sqrt(R^2 - r^2) for r < R; beside the ball, where the
/// line is taken to rise by at most 45 degrees, D <= u(r) + r. Both allow for the uncertainty of u and for
/// kPixelError. Infinite when no place is visible within kPixelRange of the ball. @param pixel its size [m]
/// @param tip_radius R [m]
[[nodiscard]] double deepest_visible(const ImageMeasurement& measured, double pixel, double tip_radius);

/// [setup] Least-squares depth D [m] of u(r) of model.md for a profile, between its largest u and the smaller
/// of ten times that and `deepest` [m]; for pictures in which the tool hides the deepest point.
[[nodiscard]] double nearest_depth(const validate::Deformation& deformation,
                                   const model::FalloffRatios& reach, double tip_radius, double deepest);

/// [setup] Measures the displacement in two photographs and compares it with the tissue's u(r).
/// @param depth D [m]; 0: the largest u or, where the tool hides it, the fitted depth, when pressed at most
/// deepest_visible() @param tip_radius R [m]
/// @throws InputError as read_picture() and measure_pictures().
[[nodiscard]] ImageSet compare_photographs(const std::filesystem::path& before,
                                           const std::filesystem::path& after, const ImageSettings& settings,
                                           const validate::Law& law, double depth, double tip_radius);

}  // namespace palpate::imaging
