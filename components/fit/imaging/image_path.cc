#include "fit/imaging/image_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/base/statistics.h"

namespace palpate::imaging {
namespace {

constexpr float kClosed = -100.0F;  // a path avoids it whenever it can

/// Largest value of each column, then the median over the columns within `half`.
std::vector<float> strongest_around(const cv::Mat& edges, int half) {
  std::vector<float> strongest(static_cast<std::size_t>(edges.cols), 0.0F);
  for (int y = 0; y < edges.rows; ++y) {
    const float* row = edges.ptr<float>(y);
    for (std::size_t x = 0; x < strongest.size(); ++x) strongest[x] = std::max(strongest[x], row[x]);
  }
  std::vector<float> around(strongest.size());
  const auto count = static_cast<int>(strongest.size());
  for (int x = 0; x < count; ++x) {
    around[static_cast<std::size_t>(x)] = static_cast<float>(median(
        {strongest.begin() + std::max(0, x - half), strongest.begin() + std::min(count, x + half + 1)}));
  }
  return around;
}

}  // namespace

cv::Mat edge_reward(const cv::Mat& gray, double sign) {
  constexpr double kSmooth = 2.0;     // px
  constexpr float kFlattest = 0.17F;  // vertical part of the gradient: up to a slope of 80 degrees
  cv::Mat quiet;
  cv::medianBlur(gray, quiet, 3);  // removes single outlying pixels
  cv::GaussianBlur(quiet, quiet, {}, kSmooth, kSmooth, cv::BORDER_REPLICATE);
  cv::Mat across;
  cv::Mat down;
  cv::Sobel(quiet, across, CV_32F, 1, 0, 3, 0.125, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(quiet, down, CV_32F, 0, 1, 3, 0.125 * sign, 0.0, cv::BORDER_REPLICATE);
  cv::Mat reward(gray.size(), CV_32F);
  for (int y = 0; y < gray.rows; ++y) {
    const float* gx = across.ptr<float>(y);
    const float* gy = down.ptr<float>(y);
    float* out = reward.ptr<float>(y);
    for (int x = 0; x < gray.cols; ++x) {
      const float size = std::hypot(gx[x], gy[x]);
      out[x] = gy[x] > kFlattest * size ? size : 0.0F;
    }
  }
  const std::vector<float> scale = strongest_around(reward, gray.cols / 10);
  for (int y = 0; y < gray.rows; ++y) {
    float* out = reward.ptr<float>(y);
    for (int x = 0; x < gray.cols; ++x) {
      const float s = scale[static_cast<std::size_t>(x)];
      out[x] = s > 0.0F ? std::min(out[x] / s, 1.0F) : 0.0F;
    }
  }
  return reward;
}

Path best_path(const cv::Mat& reward) {
  constexpr float kStepCost = 0.03F;  // per row: less than the reward of any edge
  const int rows = reward.rows;
  const int cols = reward.cols;
  cv::Mat from(rows, cols, CV_8S);
  std::vector<float> sum(static_cast<std::size_t>(rows));
  std::vector<float> next(sum.size());
  for (int y = 0; y < rows; ++y) sum[static_cast<std::size_t>(y)] = reward.at<float>(y, 0);
  for (int x = 1; x < cols; ++x) {
    for (int y = 0; y < rows; ++y) {
      float best = -1e30F;
      int step = 0;
      for (int d = -kSteepestStep; d <= kSteepestStep; ++d) {
        const int before = y - d;
        if (before < 0 || before >= rows) continue;
        const float total =
            sum[static_cast<std::size_t>(before)] - kStepCost * static_cast<float>(std::abs(d));
        if (total > best) {
          best = total;
          step = d;
        }
      }
      next[static_cast<std::size_t>(y)] = best + reward.at<float>(y, x);
      from.at<std::int8_t>(y, x) = static_cast<std::int8_t>(step);
    }
    std::swap(sum, next);
  }
  Path path;
  path.row.resize(static_cast<std::size_t>(cols));
  path.reward.resize(path.row.size());
  auto y = static_cast<int>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  for (int x = cols - 1; x >= 0; --x) {
    path.row[static_cast<std::size_t>(x)] = y;
    path.reward[static_cast<std::size_t>(x)] = reward.at<float>(y, x);
    y -= from.at<std::int8_t>(y, x);
  }
  return path;
}

void close_around(cv::Mat& reward, const Path& path, int half) {
  for (int x = 0; x < reward.cols; ++x) {
    const int row = path.row[static_cast<std::size_t>(x)];
    const int first = std::max(0, row - half);
    const int last = std::min(reward.rows - 1, row + half);
    for (int y = first; y <= last; ++y) reward.at<float>(y, x) = kClosed;
  }
}

}  // namespace palpate::imaging
