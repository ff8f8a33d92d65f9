#pragma once
#include <string>

#include "palpate/tissue.h"
#include "palpate/validation.h"
#include "science/fit/image_measure.h"

namespace palpate::fit {

/// [setup] The measured points as a deformation, both sides together by rising r; its depth is the largest u
/// where the deepest place is seen, else 0.
[[nodiscard]] Deformation deformation_of(const ImageMeasurement& measured, const std::string& name);

/// [setup] The depth D [m] with which model.md's u(r) comes nearest to a deformation, least squares; for
/// pictures in which the tool hides the deepest place. Between the largest u and ten times that.
[[nodiscard]] double nearest_depth(const Deformation& deformation, const model::ReachParameters& reach,
                                   double tip_radius);

}  // namespace palpate::fit
