#include "app/validate_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/base/units.h"

#include "app/numbers.h"

namespace palpate::app {
namespace {

/// The share of places where the model lies within what the pictures are uncertain by.
double within_uncertainty(const report::ImageSet& set) {
  std::vector<fit::ImagePoint> points = set.measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const fit::ImagePoint& a, const fit::ImagePoint& b) { return a.r < b.r; });
  std::size_t within = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = set.comparison.computed[i] - points[i].u;
    within += std::abs(off) <= points[i].uncertainty ? 1 : 0;
  }
  return static_cast<double>(within) / static_cast<double>(points.size());
}

}  // namespace

void add_image_flags(CLI::App& command, ImageFlags& flags) {
  command
      .add_option("--image", flags.files,
                  "two photographs from the side (PNG or JPEG), before and under the press or pull: the "
                  "tissue below, "
                  "the tool from above")
      ->expected(2);
  command.add_option("--scale-mm-per-px", flags.scale, "how many millimetres a pixel of the photographs is");
  command.add_flag("--fixed-camera", flags.fixed_camera,
                   "the camera stood still between the two: no turn or shift is taken out");
}

report::ImageSet validate_image(const ImageFlags& flags, const fit::Law& law, double depth,
                                double tip_radius) {
  if (flags.scale.empty()) throw InputError("--scale-mm-per-px: missing, --image needs it");
  report::ImageSet set;
  set.settings.pixel = parse_positive("--scale-mm-per-px", flags.scale) * kMillimetre;
  set.settings.direction = law.direction;
  set.settings.fixed_camera = flags.fixed_camera;
  set.before = fit::read_picture(flags.files[0]);
  set.after = fit::read_picture(flags.files[1]);
  set.measured = fit::measure_pictures(set.before, set.after, set.settings, flags.files[0], flags.files[1]);
  const fit::Deformation deformation = fit::deformation_of(set.measured, flags.files[1]);
  if (!(depth > 0.0)) depth = deformation.depth;
  if (!(depth > 0.0)) {
    depth = fit::nearest_depth(deformation, law.tissue.reach, tip_radius);
    set.depth_fitted = true;
  }
  set.comparison = fit::compare_deformation(deformation, law.tissue.reach, depth, tip_radius);
  set.within_uncertainty = within_uncertainty(set);
  return set;
}

nlohmann::ordered_json image_json(const report::ImageSet& set) {
  constexpr double kDegree = 0.017453292519943295;
  const fit::ImageMeasurement& measured = set.measured;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const fit::ImagePoint& point : measured.points) {
    points.push_back({{"x_px", point.x},
                      {"y_px", point.y},
                      {"r_mm", (point.right ? point.r : -point.r) / kMillimetre},
                      {"u_mm", point.u / kMillimetre},
                      {"uncertainty_mm", point.uncertainty / kMillimetre}});
  }
  return {{"confidence", measured.confidence},
          {"confidence_words", measured.confidence_words},
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
