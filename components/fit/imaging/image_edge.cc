#include "fit/imaging/image_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "core/base/normal_distribution.h"

namespace palpate::imaging {
namespace {

constexpr int kSamples = 2 * kEdgeReach + 1;
constexpr double kNarrowest = 0.4;  // px, least width: about one pixel
constexpr double kWidest = 6.0;

using Profile = std::array<double, kSamples>;

double bilinear(const cv::Mat& gray, double x, double y) {
  x = std::clamp(x, 0.0, static_cast<double>(gray.cols - 1));
  y = std::clamp(y, 0.0, static_cast<double>(gray.rows - 1));
  const int x0 = std::min(static_cast<int>(x), gray.cols - 2);
  const int y0 = std::min(static_cast<int>(y), gray.rows - 2);
  const double u = x - x0;
  const double v = y - y0;
  const float* top = gray.ptr<float>(y0) + x0;
  const float* bottom = gray.ptr<float>(y0 + 1) + x0;
  return (1 - v) * ((1 - u) * static_cast<double>(top[0]) + u * static_cast<double>(top[1])) +
         v * ((1 - u) * static_cast<double>(bottom[0]) + u * static_cast<double>(bottom[1]));
}

/// Brightness along the normal; each value is the mean of three samples along the line.
Profile profile_at(const cv::Mat& gray, double x, double y, double slope) {
  const double length = std::hypot(1.0, slope);
  const double tx = 1.0 / length;
  const double ty = slope / length;
  Profile profile{};
  for (int i = 0; i < kSamples; ++i) {
    const double t = i - kEdgeReach;
    for (int k = -1; k <= 1; ++k) {
      profile[static_cast<std::size_t>(i)] += bilinear(gray, x - ty * t + tx * k, y + tx * t + ty * k) / 3.0;
    }
  }
  return profile;
}

/// above, below - above, rise, offset, ln width
using Unknowns = Eigen::Matrix<double, 5, 1>;

/// Share of each sample that lies below the edge: 0 before it, 1 behind it.
Profile shares_below(const Unknowns& at) {
  constexpr double kNone = -8.3;  // widths; the share is below 1e-16
  const double width = std::exp(at[4]);
  Profile shares{};
  for (int i = 0; i < kSamples; ++i) {
    const double z = (i - kEdgeReach - at[3]) / width;
    if (z > kNone) shares[static_cast<std::size_t>(i)] = normal_cdf(z);
  }
  return shares;
}

struct Trial {
  Unknowns at = Unknowns::Zero();
  Profile shares{};  // shares_below(at)
};

/// Solves for the three linear parameters, for given offset and width. @return the sum of squares
double solve_linear(const Profile& profile, Trial& trial) {
  constexpr double kRiseWeight = 30.0;  // regularises the rise, because light changes little over the window
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  normal(2, 2) = kRiseWeight;
  Unknowns& at = trial.at;
  for (int i = 0; i < kSamples; ++i) {
    const double t = i - kEdgeReach;
    const Eigen::Vector3d row(1.0, trial.shares[static_cast<std::size_t>(i)], t);
    normal += row * row.transpose();
    right += profile[static_cast<std::size_t>(i)] * row;
  }
  at.head<3>() = normal.ldlt().solve(right);
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double t = i - kEdgeReach;
    const double miss = at[0] + at[1] * trial.shares[static_cast<std::size_t>(i)] + at[2] * t -
                        profile[static_cast<std::size_t>(i)];
    squares += miss * miss;
  }
  return squares;
}

/// Offsets and widths from which each edge is searched.
std::vector<Trial> starts_of_search() {
  std::vector<Trial> starts;
  for (const double offset : {-4.0, -2.0, 0.0, 2.0, 4.0}) {
    for (const double width : {0.8, 2.0}) {
      Trial& start = starts.emplace_back();
      start.at[3] = offset;
      start.at[4] = std::log(width);
      start.shares = shares_below(start.at);
    }
  }
  return starts;
}

/// One Gauss-Newton step in all five parameters; fills the normal matrix.
Unknowns step_from(const Profile& profile, const Trial& trial, double damping,
                   Eigen::Matrix<double, 5, 5>& normal) {
  normal.setZero();
  Unknowns right = Unknowns::Zero();
  const Unknowns& at = trial.at;
  const double width = std::exp(at[4]);
  for (int i = 0; i < kSamples; ++i) {
    const double t = i - kEdgeReach;
    const double z = (t - at[3]) / width;
    const double share = trial.shares[static_cast<std::size_t>(i)];
    const double density = normal_density(z);
    Unknowns row;
    row << 1.0, share, t, -at[1] * density / width, -at[1] * density * z;
    const double miss = profile[static_cast<std::size_t>(i)] - (at[0] + at[1] * share + at[2] * t);
    normal += row * row.transpose();
    right += miss * row;
  }
  Eigen::Matrix<double, 5, 5> damped = normal;
  damped.diagonal() *= 1.0 + damping;
  damped.diagonal().array() += 1e-9;
  return damped.ldlt().solve(right);
}

}  // namespace

Edge fit_edge(const cv::Mat& gray, double x, double y, double slope) {
  static const std::vector<Trial> starts = starts_of_search();
  const Profile profile = profile_at(gray, x, y, slope);
  Trial best;
  double least = 1e300;
  for (Trial start : starts) {
    const double squares = solve_linear(profile, start);
    if (squares < least) {
      least = squares;
      best = start;
    }
  }
  Eigen::Matrix<double, 5, 5> normal;
  double damping = 0.01;
  for (int i = 0; i < 12; ++i) {
    const Unknowns step = step_from(profile, best, damping, normal);
    Trial next = best;
    next.at[3] = std::clamp(best.at[3] + std::clamp(step[3], -1.0, 1.0), -8.0, 8.0);
    next.at[4] =
        std::clamp(best.at[4] + std::clamp(step[4], -0.5, 0.5), std::log(kNarrowest), std::log(kWidest));
    next.shares = shares_below(next.at);
    const double squares = solve_linear(profile, next);
    if (!(squares < least)) {
      damping = damping * 10.0 + 1e-3;
      continue;
    }
    const bool still = std::abs(next.at[3] - best.at[3]) < 1e-4;
    least = squares;
    best = next;
    damping *= 0.2;
    if (still) break;
  }
  Edge edge;
  edge.offset = best.at[3];
  edge.width = std::exp(best.at[4]);
  edge.above = best.at[0];
  edge.below = best.at[0] + best.at[1];
  const double freedom = kSamples - 5;
  edge.residual = std::sqrt(least / freedom);
  step_from(profile, best, 0.0, normal);
  normal.diagonal().array() += 1e-9;
  const double variance = normal.inverse()(3, 3) * least / freedom;
  edge.spread = variance > 0.0 ? std::sqrt(variance) : 0.0;
  edge.found = std::isfinite(variance) && std::abs(edge.offset) < 6.0 && edge.width < 0.9 * kWidest;
  return edge;
}

}  // namespace palpate::imaging
