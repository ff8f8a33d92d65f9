#include "fit/imaging/image_measure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"

#include "fit/imaging/image_align.h"
#include "fit/imaging/robust.h"

namespace palpate::imaging {
namespace {

constexpr double kConfident = 1.96;  // standard deviations: 95 %

std::string rounded(double value) {
  const double scale = 100.0;
  return shortest(std::round(value * scale) / scale);
}

/// Both lines in one frame, and the estimate of their relative motion.
struct Alignment {
  Frame before;
  Frame after;
  std::vector<AlignedPoint> rest;
  std::vector<Shifted> shifts;  // after the correction of rigid motion
  IndentationExtent indentation;
  bool still = false;   // the camera did not move
  Rigid rigid;          // remaining correction (nearly 0), with its uncertainty
  double far_at = 0.0;  // px: difference between likely far fields at the centre
};

/// Frame of the straight line through the trusted points between two columns.
Frame frame_of(const SurfaceLine& line, double from, double to) {
  std::vector<double> x;
  std::vector<double> y;
  const double middle = 0.5 * (from + to);
  for (const LinePoint& point : line.points) {
    if (!point.trusted || point.x < from || point.x > to) continue;
    x.push_back(point.x - middle);
    y.push_back(point.y);
  }
  Frame frame;
  if (x.size() < 20) return frame;
  const std::vector<double> straight = robust_polynomial(x, y, 1, 1.0);
  frame.pivot_x = middle;
  frame.pivot_y = straight[0];
  frame.turn = std::atan(straight[1]);
  return frame;
}

double width_of(std::span<const Shifted> shifts) {
  return shifts.empty() ? 0.0 : shifts.back().after.s - shifts.front().after.s;
}

/// Distance from the centre where the flanks begin: outside the indentation, but leaving enough of the
/// shorter side.
double flank_from(const Alignment& now, double half_widths, double least_share) {
  const double left = now.indentation.centre - now.shifts.front().after.s;
  const double right = now.shifts.back().after.s - now.indentation.centre;
  const double most = std::min(left, right) - least_share * width_of(now.shifts);
  return std::min(half_widths * now.indentation.half_width, most);
}

void shift_again(const SurfaceLine& after, Alignment& now) {
  now.shifts = shifts_between(now.rest, aligned(after, now.after));
}

/// Applies a fitted motion to the frame of the second picture; the rotation is about the frame's pivot.
void apply_correction(const Rigid& rigid, Frame& frame) {
  frame.turn += std::atan(rigid.turn);
  frame.shift_h += rigid.shift_h;
  frame.shift_s += rigid.shift_s;
}

/// First estimate from the outer fifths, before the indentation is located.
void align_ends(const SurfaceLine& after, Alignment& now) {
  for (int pass = 0; pass < 4; ++pass) {
    shift_again(after, now);
    if (now.shifts.size() < 40) return;
    const double middle = 0.5 * (now.shifts.front().after.s + now.shifts.back().after.s);
    Flanks ends;
    ends.centre = middle;
    ends.from = 0.3 * width_of(now.shifts);
    ends.shifted = now.after.shift_s;
    apply_correction(fit_rigid(now.shifts, ends), now.after);
  }
  shift_again(after, now);
}

void refuse_unless_moved(const IndentationExtent& indentation, std::span<const Shifted> shifts,
                         const ImageSettings& settings, const std::string& name) {
  std::vector<double> spreads;
  for (const Shifted& shifted : shifts) spreads.push_back(shifted.spread);
  const double least = std::max(1.0, 6.0 * median(spreads));
  constexpr double kMaxOpposite = 0.2;  // bulging beside an indentation is smaller
  const char* way = settings.direction == model::Direction::kPress ? "into" : "out of";
  const char* other = settings.direction == model::Direction::kPress ? "pull" : "press";
  if (indentation.opposite > 2.0 * indentation.peak && indentation.opposite > least) {
    throw InputError(fmt::format(
        "{}: the surface moved the other way, not {} the tissue; give --direction {}, or the pictures in "
        "their order (before, after), or an instrument that does not look like the tissue",
        name, way, other));
  }
  if (indentation.opposite > kMaxOpposite * indentation.peak && indentation.opposite > least) {
    throw InputError(
        fmt::format("{}: parts of the line moved {} the tissue, others by {} % of that the other way; must "
                    "be one indentation, and the instrument must not look like the tissue",
                    name, way, rounded(100.0 * indentation.opposite / indentation.peak)));
  }
  if (indentation.peak < least) {
    throw InputError(
        fmt::format("{}: the surface moved by no more than {} px, must be at least {} px to be measured",
                    name, rounded(std::max(0.0, indentation.peak)), rounded(least)));
  }
}

void refuse_unless_between_flanks(const Alignment& now, const std::string& name) {
  constexpr double kLeastSide = 2.5;  // half widths of the indentation: undisturbed beyond
  if (!now.indentation.found) {
    throw InputError(
        name +
        ": the two sides of the indentation are not both visible; must show the line on both sides of "
        "the instrument");
  }
  const double left = now.indentation.centre - now.shifts.front().after.s;
  const double right = now.shifts.back().after.s - now.indentation.centre;
  const double side = std::min(left, right) / now.indentation.half_width;
  if (side < kLeastSide) {
    throw InputError(fmt::format(
        "{}: the picture ends {} half widths beside the indentation, must show at least {} of the "
        "undisturbed surface on both sides",
        name, rounded(side), rounded(kLeastSide)));
  }
}

/// Far fields: none; 1/r, as for an elastic half-space; faster, as for a body that is fixed nearby; and u(r)
/// of the model with the falloff ratios of a block.
constexpr double kFarPowers[] = {0.0, kModelShape, 1.0, 1.5, 2.0, 3.0, 4.0};

std::vector<Shifted> with_sign(std::vector<Shifted> shifts, double sign) {
  for (Shifted& shifted : shifts) shifted.d *= sign;
  return shifts;
}

Flanks flanks_of(const Alignment& now, double sign) {
  Flanks flanks;
  flanks.centre = now.indentation.centre;
  flanks.reach =
      nearest_reach(with_sign(now.shifts, sign), now.indentation.centre, now.indentation.half_width);
  flanks.from = flank_from(now, 2.5, 0.12);
  flanks.most_far = now.indentation.peak * std::min(1.0, now.indentation.half_width / flanks.from);
  flanks.shifted = sign * now.after.shift_s;
  return flanks;
}

/// Mean of the fits of the flanks over all far fields, weighted by likelihood; `differ`: spread of the likely
/// ones at the indentation.
Rigid fit_far_fields(const std::vector<Shifted>& shifts, Flanks flanks, double peak, double& differ) {
  constexpr double kLeastLikely = 0.02;  // relative to the best likelihood
  constexpr double kShape = 0.003;       // of the depth: accuracy of a far field's shape
  constexpr double kPoints = 8.0;        // largest number of independent points: the residual is shape error,
                                         // not noise
  std::vector<Rigid> fits;
  for (const double power : kFarPowers) {
    flanks.power = power;
    fits.push_back(fit_rigid(shifts, flanks));
  }
  const auto best = std::min_element(fits.begin(), fits.end(),
                                     [](const Rigid& a, const Rigid& b) { return a.residual < b.residual; });
  Rigid mean = *best;
  mean.shift_h = mean.turn = mean.shift_s = 0.0;
  const auto likelihood = [best, peak](const Rigid& fit) {
    const double ratio = std::hypot(best->residual, kShape * peak) / std::hypot(fit.residual, kShape * peak);
    return std::pow(ratio, std::min({best->points, fit.points, kPoints}));
  };
  const auto at_centre = [&flanks](const Rigid& fit) { return fit.shift_h + fit.turn * flanks.centre; };
  double sum = 0.0;
  for (const Rigid& fit : fits) {
    const double weight = likelihood(fit);
    sum += weight;
    mean.shift_h += weight * fit.shift_h;
    mean.turn += weight * fit.turn;
    mean.shift_s += weight * fit.shift_s;
  }
  mean.shift_h /= sum;
  mean.turn /= sum;
  mean.shift_s /= sum;
  differ = 0.0;
  for (const Rigid& fit : fits) {
    if (likelihood(fit) < kLeastLikely) continue;
    differ = std::max(differ, std::abs(at_centre(fit) - at_centre(mean)));
    mean.uncertainty = std::max(mean.uncertainty, fit.uncertainty);
    mean.turn_uncertainty = std::max(mean.turn_uncertainty, fit.turn_uncertainty);
  }
  return mean;
}

/// Whether the flanks coincide except for a far field: then the camera was fixed, as on a tripod. A hand-held
/// camera would hardly return to within a fraction of a pixel and 0.01 degrees.
bool unmoved(const Alignment& now, double sign) {
  const double still =
      std::hypot(0.15, 0.006 * now.indentation.peak);  // px RMS: accuracy of a far field's shape
  const std::vector<Shifted> positive = with_sign(now.shifts, sign);
  Flanks flanks = flanks_of(now, sign);
  double least = 1e300;
  double least_still = 1e300;
  for (const double power : kFarPowers) {
    flanks.power = power;
    flanks.unmoved = false;
    least = std::min(least, fit_rigid(positive, flanks).residual);
    flanks.unmoved = true;
    least_still = std::min(least_still, fit_rigid(positive, flanks).residual);
  }
  return least_still < std::hypot(least, still);
}

/// Corrects rotation and shift between the pictures, from the flanks.
void align_flanks(const SurfaceLine& after, double sign, Alignment& now) {
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<Shifted> positive = with_sign(now.shifts, sign);
    now.rigid = fit_far_fields(positive, flanks_of(now, sign), now.indentation.peak, now.far_at);
    Rigid out = now.rigid;
    out.shift_h *= sign;
    out.turn *= sign;
    out.shift_s *= sign;
    apply_correction(out, now.after);
    shift_again(after, now);
    now.indentation = find_indentation(now.shifts, sign);
    if (!now.indentation.found) return;
  }
}

/// For a fixed camera the only uncertainty is that of this assumption.
bool fix_camera_if_unmoved(double sign, Alignment& now) {
  now.indentation = find_indentation(now.shifts, sign);
  if (!now.indentation.found || now.indentation.peak < 2.0 * now.indentation.opposite || !unmoved(now, sign))
    return false;
  const std::vector<Shifted> positive = with_sign(now.shifts, sign);
  double differ = 0.0;
  const Rigid found = fit_far_fields(positive, flanks_of(now, sign), now.indentation.peak, differ);
  now.far_at = std::abs(found.shift_h + found.turn * now.indentation.centre);
  now.still = true;
  return true;
}

Alignment align(const SurfaceLine& before, const SurfaceLine& after, const ImageSettings& settings,
                const std::string& name) {
  const double sign = settings.direction == model::Direction::kPress ? 1.0 : -1.0;
  Alignment now;
  double from = before.points.front().x;
  double to = before.points.back().x;
  for (int round = 0; round < 2; ++round) {  // the second round uses the direction of the surface at the
                                             // indentation
    now.before = frame_of(before, from, to);
    now.after = now.before;
    now.rest = aligned(before, now.before);
    shift_again(after, now);
    const bool still = settings.fixed_camera || fix_camera_if_unmoved(sign, now);
    if (!still) align_ends(after, now);
    now.indentation = find_indentation(now.shifts, sign);
    refuse_unless_moved(now.indentation, now.shifts, settings, name);
    refuse_unless_between_flanks(now, name);
    if (!still) align_flanks(after, sign, now);
    refuse_unless_between_flanks(now, name);
    const double centre = now.before.pivot_x + now.indentation.centre * std::cos(now.before.turn);
    from = std::max(from, centre - 3.0 * now.indentation.half_width);
    to = std::min(to, centre + 3.0 * now.indentation.half_width);
  }
  return now;
}

/// Arc length along the undisturbed line from the centre of the indentation, for each shift.
std::vector<double> arc_lengths(const Alignment& now) {
  std::vector<double> length(now.shifts.size(), 0.0);
  double centre = 0.0;
  for (std::size_t i = 1; i < length.size(); ++i) {
    const double step = now.shifts[i].after.s - now.shifts[i - 1].after.s;
    const double slope = 0.5 * (now.shifts[i].before_slope + now.shifts[i - 1].before_slope);
    const double stretch = std::hypot(1.0, slope);
    length[i] = length[i - 1] + step * stretch;
    const double into = now.indentation.centre - now.shifts[i - 1].after.s;
    if (into >= 0.0 && into <= step) centre = length[i - 1] + into * stretch;
  }
  for (double& l : length) l -= centre;
  return length;
}

void add_points(const Alignment& now, const ImageSettings& settings, ImageMeasurement& measured) {
  constexpr std::size_t kMaxPoints = 400;
  const double sign = settings.direction == model::Direction::kPress ? 1.0 : -1.0;
  const std::vector<double> along = arc_lengths(now);
  const std::size_t stride = (now.shifts.size() + kMaxPoints - 1) / kMaxPoints;
  const double c = std::cos(now.after.turn);
  const double n = std::sin(now.after.turn);
  for (std::size_t i = 0; i < now.shifts.size(); i += stride) {
    const Shifted& shifted = now.shifts[i];
    ImagePoint point;
    point.x = shifted.after.x;
    point.r = std::abs(along[i]) * settings.pixel;
    point.right = along[i] > 0.0;
    point.u = sign * shifted.d * settings.pixel;
    const double lever = std::hypot(now.rigid.uncertainty, now.rigid.turn_uncertainty * along[i]);
    const double aside = (shifted.after.slope - shifted.before_slope) *
                         now.indentation.centre_spread;  // contribution of the uncertainty of r
    const double random = kConfident * std::hypot(shifted.spread, lever, aside);
    point.uncertainty = (random + now.far_at) * settings.pixel;
    const double s = shifted.after.s + now.after.shift_s;
    const double h = shifted.after.h + now.after.shift_h;
    point.y = now.after.pivot_y + n * s + c * h;
    point.rest_y = point.y - shifted.d / std::max(0.5, c);
    measured.points.push_back(point);
  }
}

/// Increase of u away from the centre on either side, divided by the depth: u of an indentation only
/// decreases. The tenth largest value, so that single columns have no effect.
double rise_of(const ImageMeasurement& measured) {
  constexpr std::size_t kColumns = 10;
  std::vector<ImagePoint> points = measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const ImagePoint& a, const ImagePoint& b) { return a.r < b.r; });
  std::vector<double> rises;
  for (const bool right : {false, true}) {
    double lowest = 1e300;
    for (const ImagePoint& point : points) {
      if (point.right != right) continue;
      lowest = std::min(lowest, point.u + point.uncertainty);
      rises.push_back((point.u - lowest) / measured.depth);
    }
  }
  if (rises.size() < kColumns) return 0.0;
  std::nth_element(rises.begin(), rises.end() - kColumns, rises.end());
  return std::max(0.0, *(rises.end() - kColumns));
}

/// RMS difference of left and right at equal r, divided by the depth; 0 where they do not overlap.
double asymmetry_of(const ImageMeasurement& measured) {
  double squares = 0.0;
  double count = 0.0;
  for (const ImagePoint& a : measured.points) {
    if (a.right) continue;
    const ImagePoint* nearest = nullptr;
    for (const ImagePoint& b : measured.points) {
      if (b.right && (nearest == nullptr || std::abs(b.r - a.r) < std::abs(nearest->r - a.r))) nearest = &b;
    }
    if (nearest == nullptr || std::abs(nearest->r - a.r) > 0.1 * a.r) continue;
    if (std::max(a.u, nearest->u) < 0.15 * measured.depth) continue;
    squares += (a.u - nearest->u) * (a.u - nearest->u);
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) / measured.depth : 0.0;
}

/// Computes the confidence, and describes what limits it.
void rate(const ImageSettings& settings, ImageMeasurement& measured) {
  struct Link {
    double loss;
    std::string text;
  };
  const double share = measured.uncertainty / measured.depth;
  const double coverage = std::min(measured.before.coverage, measured.after.coverage);
  const double runner_up = std::max(measured.before.runner_up, measured.after.runner_up);
  std::vector<Link> links;
  links.push_back({std::min(0.9, 4.0 * share),
                   fmt::format("u is uncertain by {} % of the depth ({} px)", rounded(100.0 * share),
                               rounded(measured.uncertainty / settings.pixel))});
  links.push_back(
      {0.8 * (1.0 - coverage), "the line is seen on " + rounded(100.0 * coverage) + " % of the width"});
  links.push_back({0.8 * runner_up, "another line is " + rounded(100.0 * runner_up) + " % as plausible"});
  links.push_back({std::min(0.6, 2.0 * measured.asymmetry),
                   "left and right differ by " + rounded(100.0 * measured.asymmetry) + " % of the depth"});
  if (measured.tip_hidden) links.push_back({0.1, "the deepest point is hidden"});
  double left = 1.0;
  const Link* weakest = &links.front();
  for (const Link& link : links) {
    left *= 1.0 - link.loss;
    if (link.loss > weakest->loss) weakest = &link;
  }
  measured.confidence = static_cast<int>(std::lround(100.0 * left));
  const char* word = measured.confidence >= 70 ? "good" : measured.confidence >= 40 ? "fair" : "poor";
  measured.confidence_text = std::string(word) + ": " + weakest->text;
}

void refuse_unless_alike(const SurfaceLine& before, const SurfaceLine& after, const std::string& name) {
  const double ratio = after.contrast / before.contrast;
  if (before.dark_below != after.dark_below || ratio > 2.5 || ratio < 0.4) {
    throw InputError(
        fmt::format("{}: its line looks different from the first picture's (contrast {} against {} of "
                    "white); must be the same view in the same light",
                    name, rounded((after.dark_below ? -1.0 : 1.0) * after.contrast),
                    rounded((before.dark_below ? -1.0 : 1.0) * before.contrast)));
  }
}

void refuse_unless_certain(const ImageMeasurement& measured, const std::string& name) {
  constexpr double kMaxUncertain = 0.15;  // of the depth
  constexpr double kMaxAsymmetry = 0.12;
  constexpr double kMaxRise = 0.1;
  const double rise = rise_of(measured);
  if (rise > kMaxRise) {
    throw InputError(fmt::format(
        "{}: beside the indentation the line becomes deeper again by {} % of the depth; must be one "
        "indentation, and no object in front may look like the background",
        name, rounded(100.0 * rise)));
  }
  if (measured.asymmetry > kMaxAsymmetry) {
    throw InputError(fmt::format(
        "{}: left and right side of the indentation differ by {} % of the depth, must differ by at most "
        "12 %: the model is symmetric; check that no object hides part of the indentation",
        name, rounded(100.0 * measured.asymmetry)));
  }
  if (measured.uncertainty > kMaxUncertain * measured.depth) {
    throw InputError(fmt::format(
        "{}: the displacement is uncertain by {} % of the largest, must be at most 15 %: show more of the "
        "undisturbed surface, press deeper, or hold the camera still and give --fixed-camera",
        name, rounded(100.0 * measured.uncertainty / measured.depth)));
  }
}

}  // namespace

ImageMeasurement measure_pictures(const Picture& before, const Picture& after, const ImageSettings& settings,
                                  const std::string& before_name, const std::string& after_name) {
  if (!(settings.pixel > 0.0) || !std::isfinite(settings.pixel)) {
    throw ParameterError("scale_mm_per_px", settings.pixel * 1e3, "finite and > 0");
  }
  if (before.width != after.width || before.height != after.height) {
    throw InputError(fmt::format("{}: is {} x {} pixels, must be {} x {} as {} is", after_name, after.width,
                                 after.height, before.width, before.height, before_name));
  }
  ImageMeasurement measured;
  measured.before = find_surface_line(before, before_name);
  measured.after = find_surface_line(after, after_name);
  refuse_unless_alike(measured.before, measured.after, after_name);
  const Alignment now = align(measured.before, measured.after, settings, after_name);
  add_points(now, settings, measured);
  std::vector<double> uncertainties;
  for (const ImagePoint& point : measured.points) {
    uncertainties.push_back(point.uncertainty);
    measured.depth = std::max(measured.depth, point.u);
  }
  measured.uncertainty = median(uncertainties);
  measured.tip_hidden = now.indentation.tip_hidden;
  measured.centre_uncertainty = kConfident * now.indentation.centre_spread * settings.pixel;
  const double s = now.indentation.centre + now.after.shift_s;
  measured.centre_x = now.after.pivot_x + s * std::cos(now.after.turn);
  measured.tilt = now.before.turn;
  measured.turn = now.after.turn - now.before.turn;
  measured.shift = (now.after.shift_h - now.before.shift_h) * settings.pixel;
  measured.far_uncertainty = now.far_at * settings.pixel;
  measured.asymmetry = asymmetry_of(measured);
  rate(settings, measured);
  refuse_unless_certain(measured, after_name);
  return measured;
}

}  // namespace palpate::imaging
