#pragma once
#include <filesystem>
#include <string>

#include "view/report/page.h"

#include "fit/imaging/image_compare.h"

namespace palpate::report {

using imaging::ImageSet;

/// [setup] One line that describes the confidence of an image measurement.
[[nodiscard]] std::string image_text(const ImageSet& set);

/// [setup] Adds a section to the page and writes its figures to `folder`: both photographs with the detected
/// lines, measured displacement with its uncertainty beside the computed one, and the confidence. @throws
/// InputError when a figure cannot be written.
void write_image_section(Page& page, const ImageSet& set, const std::filesystem::path& folder);

}  // namespace palpate::report
