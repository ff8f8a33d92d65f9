#pragma once
#include <vector>

#include <opencv2/core.hpp>

namespace palpate::imaging {

/// A line from left to right: one row a column, and what it gathered.
struct Path {
  std::vector<int> row;
  std::vector<float> reward;  // of each column
};

inline constexpr int kSteepestStep = 4;  // rows a column: 76 degrees

/// [setup] How much every pixel looks like an edge (0 .. 1) with `sign` times more light below than above:
/// the gradient of a smoothed picture, against the strongest of its surroundings along the width, so that
/// uneven light does not count. @param gray CV_32F
[[nodiscard]] cv::Mat edge_reward(const cv::Mat& gray, double sign);

/// [setup] The path with the greatest sum of rewards, by dynamic programming; at most kSteepestStep rows a
/// column, and steps cost a little. Pixels below 0 are as good as closed.
[[nodiscard]] Path best_path(const cv::Mat& reward);

/// [setup] Closes the pixels within `half` rows of a path.
void close_around(cv::Mat& reward, const Path& path, int half);

}  // namespace palpate::imaging
