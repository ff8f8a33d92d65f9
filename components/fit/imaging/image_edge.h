#pragma once
#include <opencv2/core.hpp>

namespace palpate::imaging {

/// Edge profile across a line: above + rise t + (below - above) Phi((t - offset)/width), with t [px] along
/// the line's normal towards the side below.
struct Edge {
  double offset = 0.0;  // px, position of the edge relative to the search point
  double spread = 0.0;  // standard deviation of the offset
  double above = 0.0;   // brightness, 1 = white
  double below = 0.0;
  double width = 0.0;     // px, blur
  double residual = 0.0;  // RMS residual of the profile
  bool found = false;     // the edge is inside the window and narrower than it
};

inline constexpr int kEdgeReach = 10;  // px, half length of the fitted profile

/// [setup] Fits the edge profile by least squares around (x, y). @param gray CV_32F @param slope dy/dx of the
/// line
[[nodiscard]] Edge fit_edge(const cv::Mat& gray, double x, double y, double slope);

}  // namespace palpate::imaging
