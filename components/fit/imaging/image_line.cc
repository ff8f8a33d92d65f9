#include "fit/imaging/image_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/statistics.h"
#include "palpate/error.h"

#include "fit/imaging/image_edge.h"
#include "fit/imaging/robust.h"

namespace palpate::imaging {
namespace {

/// A path from left to right: one row per column, and its reward.
struct Path {
  std::vector<int> row;
  std::vector<float> reward;  // per column
};

inline constexpr int kSteepestStep = 4;  // rows per column: 76 degrees

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

/// [setup] Likelihood (0 .. 1) that a pixel is on an edge, with more light below for `sign` 1, above for -1:
/// gradient of a smoothed picture, divided by the strongest one nearby along the width to compensate uneven
/// light. @param gray CV_32F
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

/// [setup] Path of largest total reward, by dynamic programming. It may change by kSteepestStep rows per
/// column; steps have a small cost. Negative pixels are avoided.
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

/// [setup] Excludes the pixels within `half` rows of a path.
void close_around(cv::Mat& reward, const Path& path, int half) {
  for (int x = 0; x < reward.cols; ++x) {
    const int row = path.row[static_cast<std::size_t>(x)];
    const int first = std::max(0, row - half);
    const int last = std::min(reward.rows - 1, row + half);
    for (int y = first; y <= last; ++y) reward.at<float>(y, x) = kClosed;
  }
}

constexpr int kMaxColumns = 1600;  // wider pictures are scaled down
constexpr int kApart = 14;         // px: closer lines are the two sides of one edge

/// A candidate line: its path, the edge in each column and its contrast.
struct Candidate {
  double sign = 1.0;  // of brightness below minus above
  Path path;
  std::vector<double> y;  // edge position, sub-pixel
  std::vector<double> slope;
  std::vector<Edge> edges;  // in every column, or in every kStride-th to judge the line
  double contrast = 0.0;    // median over edges of the right sign; columns without an edge count 0
  double residual = 0.0;    // median
  double share = 0.0;       // fraction of columns whose edge has the sign and is not much weaker than the
                            // median
};

/// Robust straight-line fit through the neighbours within `half` columns; value and slope per column.
void smooth_rows(const std::vector<double>& rows, int half, std::vector<double>& y,
                 std::vector<double>& slope) {
  const auto count = static_cast<int>(rows.size());
  y.resize(rows.size());
  slope.resize(rows.size());
  for (int x = 0; x < count; ++x) {
    std::vector<double> at;
    std::vector<double> value;
    for (int k = std::max(0, x - half); k <= std::min(count - 1, x + half); ++k) {
      at.push_back(k - x);
      value.push_back(rows[static_cast<std::size_t>(k)]);
    }
    const std::vector<double> line = robust_polynomial(at, value, 1, 0.5);
    y[static_cast<std::size_t>(x)] = line[0];
    slope[static_cast<std::size_t>(x)] = std::clamp(line[1], -4.0, 4.0);
  }
}

bool has_sign(const Edge& edge, double sign) { return edge.found && sign * (edge.below - edge.above) > 0.0; }

/// Fits the edge in each column near the rows `y`, and moves the rows to the edges found.
void fit_edges(const cv::Mat& gray, Candidate& candidate) {
  candidate.edges.clear();
  for (std::size_t x = 0; x < candidate.y.size(); ++x) {
    const double slope = candidate.slope[x];
    const Edge edge = fit_edge(gray, static_cast<double>(x), candidate.y[x], slope);
    // from the normal to the same column, along the line
    if (has_sign(edge, candidate.sign)) candidate.y[x] += edge.offset * std::hypot(1.0, slope);
    candidate.edges.push_back(edge);
  }
}

void judge(Candidate& candidate) {
  std::vector<double> contrasts;
  std::vector<double> residuals;
  for (const Edge& edge : candidate.edges) {
    contrasts.push_back(has_sign(edge, candidate.sign) ? candidate.sign * (edge.below - edge.above) : 0.0);
    residuals.push_back(edge.residual);
  }
  candidate.contrast = median(contrasts);
  candidate.residual = median(residuals);
  const auto good = std::count_if(contrasts.begin(), contrasts.end(),
                                  [&](double c) { return c > 0.4 * candidate.contrast && c > 0.0; });
  candidate.share = static_cast<double>(good) / static_cast<double>(contrasts.size());
}

Candidate candidate_of(const cv::Mat& gray, Path path, double sign) {
  Candidate candidate;
  candidate.sign = sign;
  const std::vector<double> rows(path.row.begin(), path.row.end());
  candidate.path = std::move(path);
  smooth_rows(rows, 4, candidate.y, candidate.slope);
  constexpr std::size_t kStride = 4;  // columns: enough to judge a line
  for (std::size_t x = 0; x < candidate.y.size(); x += kStride) {
    candidate.edges.push_back(fit_edge(gray, static_cast<double>(x), candidate.y[x], candidate.slope[x]));
  }
  judge(candidate);
  return candidate;
}

/// Plausibility of a line: contrast over noise, times the fraction of the width.
double plausibility(const Candidate& candidate) {
  const double quiet = std::max(candidate.residual, 0.004);  // one step of 8 bits
  return candidate.contrast * candidate.share * std::min(1.0, candidate.contrast / (3.0 * quiet));
}

struct Best {
  Candidate line;
  double runner_up = 0.0;
};

/// The most plausible line of either sign, and the plausibility of the next one elsewhere.
Best choose(const cv::Mat& gray) {
  cv::Mat rewards[] = {edge_reward(gray, 1.0), edge_reward(gray, -1.0)};
  constexpr double kSigns[] = {1.0, -1.0};
  Candidate found[] = {candidate_of(gray, best_path(rewards[0]), 1.0),
                       candidate_of(gray, best_path(rewards[1]), -1.0)};
  const int first = plausibility(found[0]) >= plausibility(found[1]) ? 0 : 1;
  Best best;
  best.line = std::move(found[first]);
  const double most = plausibility(best.line);
  for (int i = 0; i < 2; ++i) {
    close_around(rewards[i], best.line.path, kApart);
    const Candidate other = candidate_of(gray, best_path(rewards[i]), kSigns[i]);
    if (most > 0.0) best.runner_up = std::max(best.runner_up, plausibility(other) / most);
  }
  return best;
}

/// A column is trusted when both sides look as they do elsewhere and its edge is not weaker, more blurred or
/// rougher.
std::vector<bool> trusted_columns(const Candidate& line) {
  std::vector<double> at;
  std::vector<double> above;
  std::vector<double> below;
  std::vector<double> width;
  const auto count = static_cast<double>(line.edges.size());
  for (std::size_t x = 0; x < line.edges.size(); ++x) {
    if (!has_sign(line.edges[x], line.sign)) continue;
    at.push_back(2.0 * static_cast<double>(x) / count - 1.0);
    above.push_back(line.edges[x].above);
    below.push_back(line.edges[x].below);
    width.push_back(line.edges[x].width);
  }
  std::vector<bool> trusted(line.edges.size(), false);
  if (at.size() < 20) return trusted;
  constexpr int kDegree = 3;  // of the polynomial for slow changes of light along the line
  const std::vector<double> over = robust_polynomial(at, above, kDegree, 0.15 * line.contrast);
  const std::vector<double> under = robust_polynomial(at, below, kDegree, 0.15 * line.contrast);
  const double usual_width = median(width);
  for (std::size_t x = 0; x < line.edges.size(); ++x) {
    const Edge& edge = line.edges[x];
    if (!has_sign(edge, line.sign)) continue;
    const double s = 2.0 * static_cast<double>(x) / count - 1.0;
    const double a = polynomial_at(over, s);
    const double b = polynomial_at(under, s);
    const double contrast = line.sign * (b - a);
    const double here = line.sign * (edge.below - edge.above);
    trusted[x] = contrast > 0.25 * line.contrast && here > 0.5 * contrast && here < 1.6 * contrast &&
                 std::abs(edge.above - a) < 0.3 * contrast + 2.0 * line.residual / 3.0 &&
                 std::abs(edge.below - b) < 0.4 * contrast + 2.0 * line.residual / 3.0 &&
                 edge.residual < 2.0 * line.residual + 0.03 * contrast &&
                 edge.width < 2.0 * usual_width + 0.5 && edge.spread < 1.0;
  }
  return trusted;
}

/// Columns next to a hidden stretch partly see the object; isolated trusted columns in a hidden stretch are
/// accidental.
void shrink(std::vector<bool>& trusted) {
  constexpr int kStretch = 3;  // consecutive columns that make a stretch
  constexpr int kBeside = 4;   // columns
  const std::vector<bool> before = trusted;
  const auto count = static_cast<int>(before.size());
  for (int x = 0; x < count; ++x) {
    if (before[static_cast<std::size_t>(x)]) continue;
    int from = x;
    int to = x;
    while (from > 0 && !before[static_cast<std::size_t>(from) - 1]) --from;
    while (to + 1 < count && !before[static_cast<std::size_t>(to) + 1]) ++to;
    if (to - from + 1 >= kStretch) {
      for (int k = std::max(0, from - kBeside); k <= std::min(count - 1, to + kBeside); ++k) {
        trusted[static_cast<std::size_t>(k)] = false;
      }
    }
    x = to;
  }
}

/// Local parabola through the trusted columns within `half`, and their scatter about it.
void agree_with_neighbours(const Candidate& line, const std::vector<bool>& trusted, SurfaceLine& surface) {
  constexpr int kHalf = 5;
  constexpr double kAlike = 2.0;   // neighbours share pixels, which increases variances by this factor
  constexpr double kFloor = 0.06;  // px along the normal: error of the method at an edge as sharp as a pixel
  const auto count = static_cast<int>(line.y.size());
  surface.points.resize(line.y.size());
  for (int x = 0; x < count; ++x) {
    std::vector<double> at;
    std::vector<double> value;
    std::vector<double> spreads;
    for (int k = std::max(0, x - kHalf); k <= std::min(count - 1, x + kHalf); ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (!trusted[i]) continue;
      at.push_back(k - x);
      value.push_back(line.y[i]);
      spreads.push_back(line.edges[i].spread * std::hypot(1.0, line.slope[i]));
    }
    const auto i = static_cast<std::size_t>(x);
    LinePoint& point = surface.points[i];
    point.x = x;
    point.y = line.y[i];
    point.slope = line.slope[i];
    if (!trusted[i] || at.size() < 6) continue;
    const LocalFit fit = local_parabola(at, value, std::max(0.1, 2.0 * median(spreads)));
    const double stretch = std::hypot(1.0, fit.slope);
    if (std::abs(line.y[i] - fit.value) > 4.0 * fit.scatter + 0.3 * stretch) continue;
    point.y = fit.value;
    point.slope = fit.slope;
    const double scatter = std::max(fit.scatter, median(spreads));
    // Blur shifts a curved edge towards the centre of curvature by width^2 / (2 radius).
    const double rounded = 0.5 * line.edges[i].width * line.edges[i].width * std::abs(fit.curvature);
    point.spread = std::hypot(kAlike * scatter * fit.gain, std::hypot(kFloor, rounded) * stretch);
    point.trusted = point.spread < 1.0 * stretch;
  }
}

/// Adds correlated noise (grain, shading, compression blocks) that averaging of neighbours does not remove:
/// the typical deviation from a parabola through many columns.
void add_slow_noise(SurfaceLine& surface) {
  constexpr int kHalf = 40;   // columns
  constexpr int kStride = 5;  // columns
  std::vector<double> off;
  const auto count = static_cast<int>(surface.points.size());
  for (int x = 0; x < count; x += kStride) {
    std::vector<double> at;
    std::vector<double> value;
    const LinePoint& here = surface.points[static_cast<std::size_t>(x)];
    if (!here.trusted) continue;
    for (int k = std::max(0, x - kHalf); k <= std::min(count - 1, x + kHalf); k += 2) {
      const LinePoint& point = surface.points[static_cast<std::size_t>(k)];
      if (!point.trusted) continue;
      at.push_back(static_cast<double>(k - x) / kHalf);
      value.push_back(point.y);
    }
    if (at.size() < 20) continue;
    off.push_back(here.y - robust_polynomial(at, value, 2, 1.0)[0]);
  }
  const double slow = normalized_mad(off);
  for (LinePoint& point : surface.points) {
    point.spread = std::hypot(point.spread, slow * std::hypot(1.0, point.slope));
  }
}

void refuse_unless_plausible(const Best& best, const std::string& name) {
  constexpr double kLeastContrast = 0.02;  // 5 of 255
  constexpr double kStandsOut = 2.5;       // times the residual of an edge; about 1.5 for pure noise
  const Candidate& line = best.line;
  if (line.contrast < kLeastContrast || line.contrast < kStandsOut * line.residual || line.share < 0.5) {
    throw InputError(
        name +
        ": no surface line from the left to the right side differs enough from what is around it; "
        "must show the tissue's outline against a plain background, from the side");
  }
}

void refuse_unless_sure(const SurfaceLine& surface, const std::string& name) {
  constexpr double kMaxRunnerUp = 0.5;
  constexpr double kLeastCoverage = 0.5;
  if (surface.runner_up > kMaxRunnerUp) {
    throw InputError(
        fmt::format("{}: two lines across the picture are about as plausible (the second {} % of the first); "
                    "crop both pictures to the tissue's upper outline",
                    name, static_cast<int>(std::lround(100.0 * surface.runner_up))));
  }
  if (surface.coverage < kLeastCoverage) {
    throw InputError(
        fmt::format("{}: the surface line can be trusted on {} % of the width only, must be at least 50 %: "
                    "remove what hides it, or crop",
                    name, static_cast<int>(std::lround(100.0 * surface.coverage))));
  }
}

}  // namespace

SurfaceLine find_surface_line(const Picture& picture, const std::string& name) {
  // OpenCV has no const view of external memory; the data are only read
  const cv::Mat whole(picture.height, picture.width, CV_32F, const_cast<float*>(picture.gray.data()));
  const int factor = (picture.width + kMaxColumns - 1) / kMaxColumns;
  cv::Mat gray = whole;
  if (factor > 1) {
    const cv::Mat even =
        whole(cv::Rect(0, 0, picture.width / factor * factor, picture.height / factor * factor));
    cv::resize(even, gray, {even.cols / factor, even.rows / factor}, 0.0, 0.0, cv::INTER_AREA);
  }
  Best best = choose(gray);
  refuse_unless_plausible(best, name);
  Candidate& line = best.line;
  fit_edges(gray, line);
  const std::vector<double> once = line.y;
  smooth_rows(once, 3, line.y, line.slope);  // sub-pixel rows from the edges
  fit_edges(gray, line);
  judge(line);
  std::vector<bool> trusted = trusted_columns(line);
  shrink(trusted);
  SurfaceLine surface;
  agree_with_neighbours(line, trusted, surface);
  add_slow_noise(surface);
  surface.dark_below = line.sign < 0.0;
  surface.contrast = line.contrast;
  surface.noise = line.residual;
  surface.runner_up = best.runner_up;
  const auto good = std::count_if(surface.points.begin(), surface.points.end(),
                                  [](const LinePoint& point) { return point.trusted; });
  surface.coverage = static_cast<double>(good) / static_cast<double>(surface.points.size());
  refuse_unless_sure(surface, name);
  for (LinePoint& point : surface.points) {  // back to pixels of the original picture
    point.x = factor * point.x + 0.5 * (factor - 1);
    point.y = factor * point.y + 0.5 * (factor - 1);
    point.spread *= factor;
  }
  return surface;
}

}  // namespace palpate::imaging
