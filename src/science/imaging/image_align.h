#pragma once
#include <span>
#include <vector>

#include "science/imaging/image_line.h"

namespace palpate::imaging {

/// A point of a line in the frame of the undisturbed surface [px]: s along it, h into the tissue.
struct AlignedPoint {
  double x = 0.0;  // column in the picture
  double s = 0.0;
  double h = 0.0;
  double slope = 0.0;   // dh/ds
  double spread = 0.0;  // standard deviation of h
};

/// A turn about a pivot, then a shift, that takes points of a picture to the frame above.
struct Frame {
  double pivot_x = 0.0;
  double pivot_y = 0.0;
  double turn = 0.0;  // rad, of the surface against the picture's rows; + falls to the right
  double shift_s = 0.0;
  double shift_h = 0.0;
};

/// [setup] The trusted points of a line in a frame, by rising s.
[[nodiscard]] std::vector<AlignedPoint> aligned(const SurfaceLine& line, const Frame& frame);

/// Height and slope of a line at some s; not seen where its neighbours are farther apart than a few pixels.
struct LineSample {
  bool seen = false;
  double h = 0.0;
  double slope = 0.0;
  double spread = 0.0;
};

/// [setup] @param line by rising s
[[nodiscard]] LineSample sample(std::span<const AlignedPoint> line, double s);

/// One place where both lines are seen: how far the surface went.
struct Shifted {
  AlignedPoint after;
  double before_slope = 0.0;
  double d = 0.0;       // h after less h before, px; + into the tissue
  double spread = 0.0;  // standard deviation of d, of the edges alone
};

/// [setup] Of two lines by rising s. The undisturbed line's slope is that of one smooth curve through all of
/// it.
[[nodiscard]] std::vector<Shifted> shifts_between(std::span<const AlignedPoint> before,
                                                  std::span<const AlignedPoint> after);

/// How the second picture lies against the first, by what did not move: d = shift_h + turn s - shift_s dh/ds
/// + a far field of the dent, least squares, robust.
struct Rigid {
  double shift_h = 0.0;
  double turn = 0.0;
  double shift_s = 0.0;
  double uncertainty = 0.0;       // px, standard deviation of the correction at the centre
  double turn_uncertainty = 0.0;  // rad
  double residual = 0.0;          // px, rms of the points that count
  double points = 0.0;            // as many independent ones
};

inline constexpr double kModelShape = -1.0;

/// What of a line counts as undisturbed but for a far field.
struct Flanks {
  double centre = 0.0;  // of the dent
  double from = 0.0;    // px from it
  double power = 0.0;  // the far field falls like r^-power; 0: there is none; kModelShape: as model.md's u(r)
  double reach = 0.0;  // px, R_1 of model.md, for kModelShape
  double most_far = 0.0;  // its largest size where the flanks begin
  double shifted = 0.0;   // px along the surface that were taken out before
  bool unmoved = false;   // there is no turn and no shift: the far field alone
};

/// [setup] R_1 [px] with which model.md's u(r) with the usual reach suits a dent best, its depth and height
/// free: the deepest place may be hidden.
[[nodiscard]] double nearest_reach(std::span<const Shifted> shifts, double centre, double half_width);

/// [setup]
[[nodiscard]] Rigid fit_rigid(std::span<const Shifted> shifts, const Flanks& flanks);

/// Where a dent lies and how wide it is.
struct Dent {
  bool found = false;   // both sides are seen
  double centre = 0.0;  // s
  double centre_spread = 0.0;
  double half_width = 0.0;  // at half of what is seen of its depth
  double peak = 0.0;        // largest |d| seen
  double opposite = 0.0;    // largest |d| the other way
  bool tip_hidden = false;
};

/// [setup] @param sign +1: into the tissue, -1: out of it
[[nodiscard]] Dent find_dent(std::span<const Shifted> shifts, double sign);

}  // namespace palpate::imaging
