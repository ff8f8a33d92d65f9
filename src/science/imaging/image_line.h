#pragma once
#include <string>
#include <vector>

#include "science/imaging/image_file.h"

namespace palpate::imaging {

/// Where the surface crosses one column of a picture. Pixels; y counts downwards, pixel centres at whole
/// numbers.
struct LinePoint {
  double x = 0.0;
  double y = 0.0;
  double slope = 0.0;    // dy/dx
  double spread = 0.0;   // standard deviation of y
  bool trusted = false;  // false where something hides the edge: y is only where it may be
};

/// The tissue's outline in a side view, from left to right.
struct SurfaceLine {
  std::vector<LinePoint> points;  // one a column
  bool dark_below = false;        // the tissue is darker than what is above it
  double contrast = 0.0;          // of what is below less what is above, median, share of white; > 0
  double noise = 0.0;             // what an edge of the best shape leaves, rms, share of white
  double coverage = 0.0;          // share of columns that are trusted
  double rival = 0.0;  // how plausible the next best line is: 0 not at all .. 1 as much as this one
};

/// [setup] Finds the one line that runs from the left to the right side of a picture with another brightness
/// below than above: shortest path over the gradient, then an edge profile fitted across the line at every
/// column, then neighbours that agree. A column counts only where both sides look as they do elsewhere along
/// the line (light may change slowly).
/// @param name of the picture, for messages
/// @throws InputError naming the picture, when there is no such line, only on a part of the width, or another
/// one that is as plausible.
[[nodiscard]] SurfaceLine find_surface_line(const Picture& picture, const std::string& name);

}  // namespace palpate::imaging
