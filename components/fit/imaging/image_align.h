#pragma once
#include <span>
#include <vector>

#include "fit/imaging/image_line.h"

namespace palpate::imaging {

/// A point of a surface line in the frame of the undisturbed surface [px]: s along it, h into the tissue.
struct AlignedPoint {
  double x = 0.0;  // column of the picture
  double s = 0.0;
  double h = 0.0;
  double slope = 0.0;   // dh/ds
  double spread = 0.0;  // standard deviation of h
};

/// Rigid transform from a picture to the frame of the undisturbed surface: a rotation about a pivot, then a
/// shift.
struct Frame {
  double pivot_x = 0.0;
  double pivot_y = 0.0;
  double turn = 0.0;  // rad, angle of the surface to the picture's rows; + falls to the right
  double shift_s = 0.0;
  double shift_h = 0.0;
};

/// [setup] The trusted points of a line in a frame, by increasing s.
[[nodiscard]] std::vector<AlignedPoint> aligned(const SurfaceLine& line, const Frame& frame);

/// Height and slope of a line at some s; not seen where its neighbours are more than a few pixels apart.
struct LineSample {
  bool seen = false;
  double h = 0.0;
  double slope = 0.0;
  double spread = 0.0;
};

/// [setup] @param line by increasing s
[[nodiscard]] LineSample sample(std::span<const AlignedPoint> line, double s);

/// Displacement of the surface at a point where both lines are seen.
struct Shifted {
  AlignedPoint after;
  double before_slope = 0.0;
  double d = 0.0;       // h after minus h before, px; + into the tissue
  double spread = 0.0;  // standard deviation of d from the edge fits
};

/// [setup] Displacement between two lines, both by increasing s. The slope of the undisturbed line is that of
/// one smooth curve through all its points.
[[nodiscard]] std::vector<Shifted> shifts_between(std::span<const AlignedPoint> before,
                                                  std::span<const AlignedPoint> after);

/// Rigid motion of the second picture relative to the first, from the undisturbed flanks: robust least
/// squares of d = shift_h + turn s - shift_s dh/ds + far field of the indentation.
struct Rigid {
  double shift_h = 0.0;
  double turn = 0.0;
  double shift_s = 0.0;
  double uncertainty = 0.0;       // px, standard deviation of the correction at the centre
  double turn_uncertainty = 0.0;  // rad
  double residual = 0.0;          // px, RMS over the points used
  double points = 0.0;            // their effective number of independent points
};

inline constexpr double kModelShape = -1.0;

/// The parts of a line that are undisturbed except for a far field.
struct Flanks {
  double centre = 0.0;    // centre of the indentation
  double from = 0.0;      // px from the centre
  double power = 0.0;     // the far field falls like r^-power; 0: no far field; kModelShape: u(r) of model.md
  double reach = 0.0;     // px, R_1 of model.md, for kModelShape
  double most_far = 0.0;  // largest far field where the flanks begin
  double shifted = 0.0;   // px along the surface, already corrected
  bool unmoved = false;   // fit only the far field, no rotation or shift
};

/// [setup] R_1 [px] with which u(r) of model.md (default falloff ratios) fits an indentation best; its depth
/// and height are fitted too, because the deepest point may be hidden.
[[nodiscard]] double nearest_reach(std::span<const Shifted> shifts, double centre, double half_width);

/// [setup] Fits the rigid motion.
[[nodiscard]] Rigid fit_rigid(std::span<const Shifted> shifts, const Flanks& flanks);

/// Position and width of an indentation.
struct IndentationExtent {
  bool found = false;   // whether both sides are seen
  double centre = 0.0;  // s
  double centre_spread = 0.0;
  double half_width = 0.0;  // at half of the depth that is seen
  double peak = 0.0;        // largest d that is seen
  double opposite = 0.0;    // largest d of the opposite sign
  bool tip_hidden = false;
};

/// [setup] @param sign +1: into the tissue, -1: out of it
[[nodiscard]] IndentationExtent find_indentation(std::span<const Shifted> shifts, double sign);

}  // namespace palpate::imaging
