#pragma once
#include <filesystem>
#include <string>

#include "palpate/fit/image_compare.h"
#include "palpate/fit/image_file.h"
#include "palpate/fit/validation.h"
#include "palpate/report/page.h"

namespace palpate::report {

/// A deformation that was measured in two photographs, and the model's.
struct ImageSet {
  fit::Picture before;
  fit::Picture after;
  fit::ImageMeasurement measured;
  fit::ImageSettings settings;
  fit::DeformationComparison comparison;
  bool depth_fitted = false;  // the depth is the one that suits the line best
  double within_uncertainty =
      0.0;  // share of points where the model lies within what the picture is uncertain by
};

/// [setup] How sure a measurement is, in one line for people.
[[nodiscard]] std::string image_text(const ImageSet& set);

/// [setup] Adds a section to a page and its figures to `folder`: both photographs with the lines that were
/// found, measured displacement with its uncertainty beside the computed one, and how sure it all is.
/// @throws InputError when a figure cannot be written.
void write_image_section(Page& page, const ImageSet& set, const std::filesystem::path& folder);

}  // namespace palpate::report
