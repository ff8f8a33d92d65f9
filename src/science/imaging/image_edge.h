#pragma once
#include <opencv2/core.hpp>

namespace palpate::imaging {

/// The edge across a line at one place: above + rise t + (below - above) Phi((t - offset)/width), t the way
/// [px] along the line's normal into what is below.
struct Edge {
  double offset = 0.0;  // px, of the edge from where it was looked for
  double spread = 0.0;  // standard deviation of the offset
  double above = 0.0;   // brightness, share of white
  double below = 0.0;
  double width = 0.0;     // px: how blurred
  double residual = 0.0;  // rms that the profile leaves
  bool found = false;     // the profile has an edge inside the window, narrower than it
};

inline constexpr int kEdgeReach = 10;  // px, either way, that a profile is looked at

/// [setup] Fits the edge profile by least squares around (x, y). @param gray CV_32F
/// @param slope dy/dx of the line there
[[nodiscard]] Edge fit_edge(const cv::Mat& gray, double x, double y, double slope);

}  // namespace palpate::imaging
