#pragma once
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "fit/imaging/compare.h"
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

/// [setup] The photographs of the flags; absent without --image. @throws InputError without a scale
[[nodiscard]] std::optional<imaging::Photographs> photographs_of(const ImageFlags& flags);

/// [setup] The measurement itself as JSON: its points, uncertainty and alignment (docs/photographs.md).
[[nodiscard]] nlohmann::ordered_json image_json(const report::ImageSet& set);

}  // namespace palpate::app
