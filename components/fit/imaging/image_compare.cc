#include "fit/imaging/image_compare.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "palpate/surface.h"

namespace palpate::imaging {
namespace {

double squares(const validate::Deformation& deformation, const model::FalloffRatios& reach, double depth,
               double tip_radius) {
  const deform::DisplacementProfile profile(reach, depth, tip_radius, tip_radius);
  double sum = 0.0;
  for (std::size_t i = 0; i < deformation.size(); ++i) {
    const double off = profile.at(deformation.distance[i]) - deformation.displacement[i];
    sum += off * off;
  }
  return sum;
}

/// Fraction of the points where the model is within the measurement's uncertainty.
double within_uncertainty(const ImageSet& set) {
  std::vector<ImagePoint> points = set.measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const ImagePoint& a, const ImagePoint& b) { return a.r < b.r; });
  std::size_t within = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = set.comparison.computed[i] - points[i].u;
    within += std::abs(off) <= points[i].uncertainty ? 1 : 0;
  }
  return static_cast<double>(within) / static_cast<double>(points.size());
}

}  // namespace

validate::Deformation deformation_of(const ImageMeasurement& measured, const std::string& name) {
  std::vector<ImagePoint> points = measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const ImagePoint& a, const ImagePoint& b) { return a.r < b.r; });
  validate::Deformation deformation;
  deformation.name = name;
  if (!measured.tip_hidden) deformation.depth = measured.depth;
  for (const ImagePoint& point : points) {
    deformation.distance.push_back(point.r);
    deformation.displacement.push_back(point.u);
  }
  return deformation;
}

double deepest_visible(const ImageMeasurement& measured, double pixel, double tip_radius) {
  double deepest = std::numeric_limits<double>::infinity();
  for (const ImagePoint& point : measured.points) {
    if (point.r > tip_radius + kPixelRange * pixel) continue;
    const double r = point.r + kPixelError * pixel;
    const double above = r < tip_radius ? tip_radius - std::sqrt(tip_radius * tip_radius - r * r) : r;
    deepest = std::min(deepest, point.u + point.uncertainty + above);
  }
  return deepest;
}

double nearest_depth(const validate::Deformation& deformation, const model::FalloffRatios& reach,
                     double tip_radius, double deepest) {
  constexpr int kSteps = 100;
  constexpr double kMax = 10.0;  // a tool may hide most of the depth
  const double largest = *std::max_element(deformation.displacement.begin(), deformation.displacement.end());
  double best = largest;
  double low = 0.7 * largest;
  double high = std::max(largest, std::min(kMax * largest, deepest));
  const double end = high;
  for (int round = 0; round < 4; ++round) {  // each round is a grid around the optimum of the previous one
    const double step = (high - low) / kSteps;
    double least = 1e300;
    for (int i = 0; i <= kSteps; ++i) {
      const double depth = low + step * i;
      const double sum = squares(deformation, reach, depth, tip_radius);
      if (sum < least) {
        least = sum;
        best = depth;
      }
    }
    low = best - step;
    high = std::min(end, best + step);
  }
  return std::max(best, largest);
}

ImageSet compare_photographs(const std::filesystem::path& before, const std::filesystem::path& after,
                             const ImageSettings& settings, const validate::Law& law, double depth,
                             double tip_radius) {
  ImageSet set;
  set.settings = settings;
  set.before = read_picture(before);
  set.after = read_picture(after);
  set.measured = measure_pictures(set.before, set.after, set.settings, before.string(), after.string());
  const validate::Deformation deformation = deformation_of(set.measured, after.string());
  if (!(depth > 0.0)) depth = deformation.depth;
  if (!(depth > 0.0)) {
    const bool ball = law.direction == model::Direction::kPress;
    const double deepest = ball ? deepest_visible(set.measured, settings.pixel, tip_radius)
                                : std::numeric_limits<double>::infinity();
    depth = nearest_depth(deformation, law.tissue.reach, tip_radius, deepest);
    set.depth_fitted = true;
  }
  set.comparison = validate::compare_deformation(deformation, law.tissue.reach, depth, tip_radius);
  set.within_uncertainty = within_uncertainty(set);
  return set;
}

}  // namespace palpate::imaging
