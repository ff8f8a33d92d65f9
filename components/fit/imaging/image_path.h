#pragma once
#include <vector>

#include <opencv2/core.hpp>

namespace palpate::imaging {

/// A path from left to right: one row per column, and its reward.
struct Path {
  std::vector<int> row;
  std::vector<float> reward;  // per column
};

inline constexpr int kSteepestStep = 4;  // rows per column: 76 degrees

/// [setup] Likelihood (0 .. 1) that a pixel is on an edge, with more light below for `sign` 1, above for -1:
/// gradient of a smoothed picture, divided by the strongest one nearby along the width to compensate uneven
/// light. @param gray CV_32F
[[nodiscard]] cv::Mat edge_reward(const cv::Mat& gray, double sign);

/// [setup] Path of largest total reward, by dynamic programming. It may change by kSteepestStep rows per
/// column; steps have a small cost. Negative pixels are avoided.
[[nodiscard]] Path best_path(const cv::Mat& reward);

/// [setup] Excludes the pixels within `half` rows of a path.
void close_around(cv::Mat& reward, const Path& path, int half);

}  // namespace palpate::imaging
