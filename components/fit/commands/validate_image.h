#pragma once
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "palpate/validate.h"

#include "fit/report/image_section.h"

namespace palpate::app {

/// The flags of `palpate validate` for photographs.
struct ImageFlags {
  std::vector<std::string> files;  // before, after
  double pixel = 0.0;              // size of a pixel [m]; 0: not given
  bool fixed_camera = false;
};

/// [setup] Adds --image, --scale-mm-per-px and --fixed-camera to a command.
void add_image_flags(CLI::App& command, ImageFlags& flags);

/// [setup] Measures the surface displacement in the photographs and compares it with the tissue's u(r).
/// @param depth D [m]; 0: the largest measured displacement, or, where the tool hides it, the depth that fits
/// the surface line best @param tip_radius R [m] @throws InputError as read_picture() and measure_pictures()
/// do, and for missing flags.
[[nodiscard]] report::ImageSet validate_image(const ImageFlags& flags, const validate::Law& law, double depth,
                                              double tip_radius);

/// [setup] The measurement itself as JSON: its points, uncertainty and alignment (docs/photographs.md).
[[nodiscard]] nlohmann::ordered_json image_json(const report::ImageSet& set);

}  // namespace palpate::app
