#pragma once
#include <string>
#include <vector>

#include "fit/imaging/image_file.h"

namespace palpate::imaging {

/// Position of the surface line in one column. Pixels; y points down, pixel centres are at integers.
struct LinePoint {
  double x = 0.0;
  double y = 0.0;
  double slope = 0.0;    // dy/dx
  double spread = 0.0;   // standard deviation of y
  bool trusted = false;  // false where an object hides the edge: y is then an estimate
};

/// Outline of the tissue in a side view, from left to right.
struct SurfaceLine {
  std::vector<LinePoint> points;  // one per column
  bool dark_below = false;        // the tissue is darker than the background above it
  double contrast = 0.0;          // median difference of brightness between below and above, 1 = white; > 0
  double noise = 0.0;             // RMS residual of the edge profiles, 1 = white
  double coverage = 0.0;          // fraction of trusted columns
  double runner_up = 0.0;         // plausibility of the next best line: 0 none .. 1 equal to this one
};

/// [setup] Finds the line from the left to the right side of a picture where the brightness changes. Steps:
/// shortest path over the gradient, edge profile fitted across the line in each column, consistency with
/// neighbours. A column is trusted only where both sides look as elsewhere along the line (slow changes of
/// light are allowed).
/// @param name of the picture, for messages
/// @throws InputError that names the picture when there is no such line, it covers only a part of the width,
/// or another line is as plausible.
[[nodiscard]] SurfaceLine find_surface_line(const Picture& picture, const std::string& name);

}  // namespace palpate::imaging
