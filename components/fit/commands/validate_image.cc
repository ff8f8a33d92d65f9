#include "fit/commands/validate_image.h"

#include <algorithm>
#include <utility>

#include "palpate/error.h"
#include "palpate/units.h"

#include "app/numbers.h"

namespace palpate::app {

void add_image_flags(CLI::App& command, ImageFlags& flags) {
  CLI::Option* image =
      command
          .add_option("--image", flags.files,
                      "two photographs from the side (PNG or JPEG), before and during the press or pull: the "
                      "tissue is at the bottom, the tool comes from above")
          ->expected(2);
  add_number(command, "--scale-mm-per-px", flags.pixel, Numbers::kPositive,
             "size of a pixel of the photographs in millimetres", kMillimetre)
      ->needs(image);
  command
      .add_flag("--fixed-camera", flags.fixed_camera,
                "the camera did not move between the photographs: correct no rotation or shift")
      ->needs(image);
}

std::optional<imaging::Photographs> photographs_of(const ImageFlags& flags) {
  if (flags.files.empty()) return std::nullopt;
  if (flags.pixel == 0.0) throw InputError("--scale-mm-per-px: missing, --image needs it");
  return imaging::Photographs{flags.files[0], flags.files[1], flags.pixel, flags.fixed_camera};
}

nlohmann::ordered_json image_json(const report::ImageSet& set) {
  constexpr double kDegree = 0.017453292519943295;
  const imaging::ImageMeasurement& measured = set.measured;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const imaging::ImagePoint& point : measured.points) {
    points.push_back({{"x_px", point.x},
                      {"y_px", point.y},
                      {"r_mm", (point.right ? point.r : -point.r) / kMillimetre},
                      {"u_mm", point.u / kMillimetre},
                      {"uncertainty_mm", point.uncertainty / kMillimetre}});
  }
  return {{"confidence", measured.confidence},
          {"confidence_text", measured.confidence_text},
          {"uncertainty_mm", measured.uncertainty / kMillimetre},
          {"far_uncertainty_mm", measured.far_uncertainty / kMillimetre},
          {"within_uncertainty", set.within_uncertainty},
          {"coverage", std::min(measured.before.coverage, measured.after.coverage)},
          {"tip_hidden", measured.tip_hidden},
          {"depth_fitted", set.depth_fitted},
          {"centre_x_px", measured.centre_x},
          {"centre_uncertainty_mm", measured.centre_uncertainty / kMillimetre},
          {"tilt_deg", measured.tilt / kDegree},
          {"turn_deg", measured.turn / kDegree},
          {"shift_mm", measured.shift / kMillimetre},
          {"asymmetry", measured.asymmetry},
          {"points", std::move(points)}};
}

}  // namespace palpate::app
