#include "fit/imaging/image_align.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "core/base/statistics.h"

#include "fit/imaging/robust.h"

namespace palpate::imaging {
namespace {

constexpr double kGap = 4.0;  // px, largest gap within one stretch

/// d after a median filter over five neighbours.
std::vector<double> calmed(std::span<const Shifted> shifts, double sign) {
  std::vector<double> calm(shifts.size());
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const std::size_t from = i < 2 ? 0 : i - 2;
    const std::size_t to = std::min(shifts.size(), i + 3);
    std::vector<double> window;
    for (std::size_t k = from; k < to; ++k) window.push_back(sign * shifts[k].d);
    calm[i] = median(window);
  }
  return calm;
}

/// First s, from the left or right end, where d crosses `level` before index `until`; false where the
/// crossing is not seen.
bool crossing(std::span<const Shifted> shifts, const std::vector<double>& d, double level, bool from_left,
              std::size_t until, double& s) {
  const std::size_t count = d.size();
  for (std::size_t step = 0; step + 1 < count; ++step) {
    const std::size_t a = from_left ? step : count - 1 - step;
    const std::size_t b = from_left ? a + 1 : a - 1;
    if (from_left ? b > until : b < until) return false;
    if (d[a] < level && d[b] >= level) {
      if (std::abs(shifts[b].after.s - shifts[a].after.s) > kGap) return false;
      const double share = (level - d[a]) / (d[b] - d[a]);
      s = shifts[a].after.s + share * (shifts[b].after.s - shifts[a].after.s);
      return true;
    }
  }
  return false;
}

/// Shape of u(r) with the default falloff ratios (model.md, section 3).
double model_shape(double r, double first) {
  constexpr double kReach[] = {1.0, 1.43, 2.204, 3.597, 6.105, 10.62};  // R_i / R_1 with a = 0.43, s = 1.8
  double sum = 0.0;
  double weight = 1.0;
  for (const double reach : kReach) {
    const double share = r / (first * reach);
    sum += weight * std::max(0.0, 1.0 - share * share);
    weight *= 0.58;
  }
  return sum;
}

/// Normalised to 1 where the flanks begin.
double far_field(const Flanks& flanks, double r) {
  if (flanks.power == 0.0) return 0.0;
  if (flanks.power != kModelShape) return std::pow(flanks.from / r, flanks.power);
  return model_shape(r, flanks.reach) / std::max(1e-9, model_shape(flanks.from, flanks.reach));
}

}  // namespace

std::vector<AlignedPoint> aligned(const SurfaceLine& line, const Frame& frame) {
  const double c = std::cos(frame.turn);
  const double n = std::sin(frame.turn);
  std::vector<AlignedPoint> points;
  for (const LinePoint& point : line.points) {
    if (!point.trusted) continue;
    const double x = point.x - frame.pivot_x;
    const double y = point.y - frame.pivot_y;
    AlignedPoint to;
    to.x = point.x;
    to.s = c * x + n * y - frame.shift_s;
    to.h = -n * x + c * y - frame.shift_h;
    to.slope = std::tan(std::clamp(std::atan(point.slope) - frame.turn, -1.5, 1.5));
    to.spread = point.spread * std::abs(c - n * to.slope);
    points.push_back(to);
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const AlignedPoint& a, const AlignedPoint& b) { return a.s < b.s; });
  return points;
}

LineSample sample(std::span<const AlignedPoint> line, double s) {
  LineSample found;
  const auto after = std::lower_bound(
      line.begin(), line.end(), s, [](const AlignedPoint& point, double value) { return point.s < value; });
  if (after == line.begin() || after == line.end()) return found;
  const AlignedPoint& a = *(after - 1);
  const AlignedPoint& b = *after;
  if (!(b.s > a.s) || b.s - a.s > kGap) return found;
  const double share = (s - a.s) / (b.s - a.s);
  found.seen = true;
  found.h = a.h + share * (b.h - a.h);
  found.slope = a.slope + share * (b.slope - a.slope);
  found.spread = std::max(a.spread, b.spread);
  return found;
}

std::vector<Shifted> shifts_between(std::span<const AlignedPoint> before,
                                    std::span<const AlignedPoint> after) {
  constexpr int kDegree = 5;
  std::vector<double> s;
  std::vector<double> h;
  double widest = 1.0;
  for (const AlignedPoint& point : before) widest = std::max(widest, std::abs(point.s));
  for (const AlignedPoint& point : before) {
    s.push_back(point.s / widest);
    h.push_back(point.h);
  }
  std::vector<double> smooth(kDegree + 1, 0.0);
  if (s.size() > kDegree) smooth = robust_polynomial(s, h, kDegree, 0.5);
  std::vector<double> derivative;
  for (std::size_t k = 1; k < smooth.size(); ++k)
    derivative.push_back(static_cast<double>(k) * smooth[k] / widest);
  std::vector<Shifted> shifts;
  for (const AlignedPoint& point : after) {
    const LineSample under = sample(before, point.s);
    if (!under.seen) continue;
    Shifted shifted;
    shifted.after = point;
    shifted.before_slope = polynomial_at(derivative, point.s / widest);
    shifted.d = point.h - under.h;
    shifted.spread = std::hypot(point.spread, under.spread);
    shifts.push_back(shifted);
  }
  return shifts;
}

double nearest_reach(std::span<const Shifted> shifts, double centre, double half_width) {
  constexpr double kFarthest = 5.0;  // half widths: limits the fit to the indentation itself
  double best = half_width;
  double least = 1e300;
  double share = 0.4;
  while (share < 1.6) {
    const double first = share * half_width;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-9;
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double squares = 0.0;
    for (const Shifted& shifted : shifts) {
      const double r = std::abs(shifted.after.s - centre);
      if (r > kFarthest * half_width) continue;
      const Eigen::Vector2d row(model_shape(r, first), 1.0);
      normal += row * row.transpose();
      right += shifted.d * row;
      squares += shifted.d * shifted.d;
    }
    const double left = squares - right.dot(normal.ldlt().solve(right));
    if (left < least) {
      least = left;
      best = first;
    }
    share *= 1.04;
  }
  return best;
}

Rigid fit_rigid(std::span<const Shifted> shifts, const Flanks& flanks) {
  constexpr double kUsualShift = 20.0;  // px along the surface; a prior, because a straight or circular line
                                        // does not determine this shift
  constexpr double kAlike = 8.0;        // number of correlated neighbours that count as one point
  const bool with_far = flanks.power != 0.0;
  Eigen::Vector4d solved = Eigen::Vector4d::Zero();
  Rigid rigid;
  double scale = 1e300;
  for (int pass = 0; pass < 16; ++pass) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    std::vector<double> residuals;
    double count = 0.0;
    double squares = 0.0;
    for (const Shifted& shifted : shifts) {
      const double r = std::abs(shifted.after.s - flanks.centre);
      if (r < flanks.from) continue;
      const Eigen::Vector4d row(1.0, 0.01 * (shifted.after.s - flanks.centre), -shifted.before_slope,
                                far_field(flanks, r));
      const double off = shifted.d - row.dot(solved);
      const double weight = 1.0 / std::pow(1.0 + (off / scale) * (off / scale), 2);
      normal += weight * row * row.transpose();
      right += weight * shifted.d * row;
      residuals.push_back(std::abs(off));
      count += weight;
      squares += weight * off * off;
    }
    const double variance = std::max(squares / std::max(1.0, count - 4.0), 1e-4);
    const double usual = kAlike * std::max(variance, 0.0025) / (kUsualShift * kUsualShift);
    normal(2, 2) += usual;
    right[2] -= usual * flanks.shifted;
    if (!with_far) normal(3, 3) += 1.0;
    if (flanks.unmoved) normal.diagonal().head<3>().array() += 1e9;
    normal.diagonal().array() += 1e-9;
    solved = normal.ldlt().solve(right);
    const Eigen::Matrix4d covariance = normal.inverse() * variance * kAlike;
    rigid.uncertainty = std::sqrt(std::max(0.0, covariance(0, 0)));
    rigid.turn_uncertainty = 0.01 * std::sqrt(std::max(0.0, covariance(1, 1)));
    rigid.residual = std::sqrt(variance);
    rigid.points = count / kAlike;
    if (with_far && (solved[3] < 0.0 || solved[3] > flanks.most_far)) {
      // outside the range of elastic behaviour: fixed at the bound
      normal(3, 3) += 1e9;
      right[3] += 1e9 * std::clamp(solved[3], 0.0, flanks.most_far);
      solved = normal.ldlt().solve(right);
    }
    scale = std::max(0.15, 4.0 * median(residuals));
  }
  rigid.shift_h = solved[0] - 0.01 * flanks.centre * solved[1];
  rigid.turn = 0.01 * solved[1];
  rigid.shift_s = solved[2];
  return rigid;
}

IndentationExtent find_indentation(std::span<const Shifted> shifts, double sign) {
  IndentationExtent indentation;
  if (shifts.size() < 10) return indentation;
  const std::vector<double> d = calmed(shifts, sign);
  const auto top = std::max_element(d.begin(), d.end());
  indentation.peak = *top;
  indentation.opposite = -*std::min_element(d.begin(), d.end());
  auto middle = static_cast<std::size_t>(top - d.begin());
  double left_peak = indentation.peak;
  double right_peak = indentation.peak;
  // a hidden stretch next to the largest d seen, with a large d on its other side: it hides the tip
  double widest = 2.0 * kGap;
  const std::size_t top_at = middle;
  for (std::size_t i = top_at < 5 ? 0 : top_at - 5; i + 1 < d.size() && i < top_at + 5; ++i) {
    const double gap = shifts[i + 1].after.s - shifts[i].after.s;
    if (gap > widest && std::min(d[i], d[i + 1]) > 0.4 * indentation.peak) {
      widest = gap;
      indentation.tip_hidden = true;
      middle = i;
    }
  }
  if (indentation.tip_hidden) {
    const auto split = d.begin() + static_cast<std::ptrdiff_t>(middle) + 1;
    left_peak = *std::max_element(d.begin(), split);
    right_peak = *std::max_element(split, d.end());
  }
  std::vector<double> middles;
  const double common = std::min(left_peak, right_peak);
  double nearest = 1.0;
  for (int i = 0; i <= 12; ++i) {
    const double share = 0.2 + 0.05 * i;
    double left = 0.0;
    double right = 0.0;
    if (!crossing(shifts, d, share * common, true, middle, left) ||
        !crossing(shifts, d, share * common, false, middle, right)) {
      continue;
    }
    middles.push_back(0.5 * (left + right));
    if (std::abs(share - 0.5) < nearest) {
      nearest = std::abs(share - 0.5);
      indentation.half_width = 0.5 * (right - left);
    }
  }
  if (middles.size() < 3) return indentation;
  indentation.centre = median(middles);
  std::vector<double> off;
  for (const double m : middles) off.push_back(std::abs(m - indentation.centre));
  indentation.centre_spread = 1.5 * median(off) + 0.1;
  indentation.found = true;
  return indentation;
}

}  // namespace palpate::imaging
