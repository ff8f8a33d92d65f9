#pragma once
#include <filesystem>
#include <string>

#include "science/imaging/image_compare.h"
#include "view/report/page.h"

namespace palpate::report {

using imaging::ImageSet;

/// [setup] How sure a measurement is, in one line for people.
[[nodiscard]] std::string image_text(const ImageSet& set);

/// [setup] Adds a section to a page and its figures to `folder`: both photographs with the lines that were
/// found, measured displacement with its uncertainty beside the computed one, and how sure it all is.
/// @throws InputError when a figure cannot be written.
void write_image_section(Page& page, const ImageSet& set, const std::filesystem::path& folder);

}  // namespace palpate::report
