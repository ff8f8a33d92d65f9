#pragma once
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "palpate/validate.h"
#include "view/report/image_section.h"

namespace palpate::app {

/// The flags of `palpate validate` that are about photographs.
struct ImageFlags {
  std::vector<std::string> files;  // before, after
  double pixel = 0.0;              // m; 0: not given
  bool fixed_camera = false;
};

/// [setup]
void add_image_flags(CLI::App& command, ImageFlags& flags);

/// [setup] Measures the pictures and compares with the tissue's u(r). @param depth D [m]; 0: the largest u,
/// or, where the tool hides it, the depth that suits the line best @param tip_radius R [m]
/// @throws InputError as read_picture() and measure_pictures(), and for flags that are missing.
[[nodiscard]] report::ImageSet validate_image(const ImageFlags& flags, const validate::Law& law, double depth,
                                              double tip_radius);

/// [setup] What is known of the measurement beside the comparison (docs/photographs.md).
[[nodiscard]] nlohmann::ordered_json image_json(const report::ImageSet& set);

}  // namespace palpate::app
