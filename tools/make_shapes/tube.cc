#include "tools/make_shapes/tube.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate::geometry {

namespace {
constexpr int kPieces = 5;  // per span
constexpr std::array<std::size_t, 4> kAll{0, 1, 2, 3};
}  // namespace

Tube::Tube(const std::vector<TubeKnot>& knots, double far) : end_(knots.back()), far_(far) {
  fit(knots);
  divide();
}

/// Second derivatives at the knots from the tridiagonal system of a natural cubic spline, for equal parameter
/// steps; 0 at both ends.
void Tube::fit(const std::vector<TubeKnot>& knots) {
  const std::size_t count = knots.size();
  std::vector<Four> y;
  for (const TubeKnot& k : knots) y.push_back({k.middle.x(), k.middle.y(), k.middle.z(), k.radius});
  std::vector<Four> bend(count, Four{});
  std::vector<double> upper(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double pivot = 4.0 - upper[i - 1];
    upper[i] = 1.0 / pivot;
    for (const std::size_t k : kAll) {
      const double right = 6.0 * (y[i + 1][k] - 2.0 * y[i][k] + y[i - 1][k]);
      bend[i][k] = (right - bend[i - 1][k]) / pivot;
    }
  }
  for (std::size_t i = count - 1; i-- > 1;) {
    for (const std::size_t k : kAll) bend[i][k] -= upper[i] * bend[i + 1][k];
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    Span s;
    for (const std::size_t k : kAll) {
      s.a[k] = y[i][k];
      s.b[k] = y[i + 1][k] - y[i][k] - (2.0 * bend[i][k] + bend[i + 1][k]) / 6.0;
      s.c[k] = 0.5 * bend[i][k];
      s.d[k] = (bend[i + 1][k] - bend[i][k]) / 6.0;
    }
    spans_.push_back(s);
  }
}

void Tube::divide() {
  const std::size_t count = spans_.size() * kPieces;
  std::vector<Four> line;
  for (std::size_t i = 0; i <= count; ++i) line.push_back(jet(static_cast<double>(i) / kPieces).value);
  box_ = {Vec3(line[0][0], line[0][1], line[0][2]), Vec3(line[0][0], line[0][1], line[0][2])};
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec3 middle(line[i][0], line[i][1], line[i][2]);
    const Vec3 around = Vec3::Constant(line[i][3]);
    box_.low = box_.low.cwiseMin(middle - around);
    box_.high = box_.high.cwiseMax(middle + around);
    if (i == count) break;
    Piece piece;
    for (std::size_t k = 0; k < 3; ++k) {
      piece.start[k] = line[i][k];
      piece.along[k] = line[i + 1][k] - line[i][k];
      piece.length2 += piece.along[k] * piece.along[k];
    }
    piece.radius = line[i][3];
    piece.taper = line[i + 1][3] - line[i][3];
    pieces_.push_back(piece);
  }
}

Tube::Jet Tube::jet(double u) const noexcept {
  const double last = static_cast<double>(spans_.size() - 1);
  const double whole = std::clamp(std::floor(u), 0.0, last);
  const Span& s = spans_[static_cast<std::size_t>(whole)];
  const double t = u - whole;
  Jet jet;
  for (const std::size_t k : kAll) {
    jet.value[k] = s.a[k] + t * (s.b[k] + t * (s.c[k] + t * s.d[k]));
    jet.first[k] = s.b[k] + t * (2.0 * s.c[k] + t * 3.0 * s.d[k]);
    jet.second[k] = 2.0 * s.c[k] + 6.0 * t * s.d[k];
  }
  return jet;
}

TubeKnot Tube::knot_at(double share) const noexcept {
  const Four v = jet(std::clamp(share, 0.0, 1.0) * static_cast<double>(spans_.size())).value;
  return {Vec3(v[0], v[1], v[2]), v[3]};
}

Vec3 Tube::end_direction() const noexcept {
  const Four v = jet(static_cast<double>(spans_.size())).first;
  return Vec3(v[0], v[1], v[2]).normalized();
}

double Tube::rough_place(const Vec3& p) const noexcept {
  // Scalars in these inner loops, because Eigen expressions are slow in unoptimised builds.
  const double px = p.x();
  const double py = p.y();
  const double pz = p.z();
  double least = 1e9;
  double place = 0.0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const double x = px - piece.start[0];
    const double y = py - piece.start[1];
    const double z = pz - piece.start[2];
    double t = (x * piece.along[0] + y * piece.along[1] + z * piece.along[2]) / piece.length2;
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    const double dx = x - t * piece.along[0];
    const double dy = y - t * piece.along[1];
    const double dz = z - t * piece.along[2];
    const double value = std::sqrt(dx * dx + dy * dy + dz * dz) - (piece.radius + t * piece.taper);
    if (value >= least) continue;
    least = value;
    place = (static_cast<double>(i) + t) / kPieces;
  }
  return place;
}

FieldValue Tube::at(const Vec3& p) const noexcept {
  double away2 = 0.0;
  double off[3] = {0.0, 0.0, 0.0};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double x = p[k];
    if (x < box_.low[k]) off[k] = x - box_.low[k];
    if (x > box_.high[k]) off[k] = x - box_.high[k];
    away2 += off[k] * off[k];
  }
  if (away2 > far_ * far_) {
    const double away = std::sqrt(away2);
    return {away, Vec3(off[0] / away, off[1] / away, off[2] / away)};
  }
  constexpr int kNewtonSteps = 4;
  constexpr double kLongestStep = 1.0 / kPieces;
  const double last = static_cast<double>(spans_.size());
  double u = rough_place(p);
  double arm[3];
  double distance = 0.0;
  double radius = 0.0;
  for (int step = 0;; ++step) {
    const Jet here = jet(u);
    double arm2 = 0.0;
    double slope = 0.0;   // arm . first
    double speed2 = 0.0;  // first . first
    double curl = 0.0;    // arm . second
    for (std::size_t k = 0; k < 3; ++k) {
      arm[k] = p[static_cast<Eigen::Index>(k)] - here.value[k];
      arm2 += arm[k] * arm[k];
      slope += arm[k] * here.first[k];
      speed2 += here.first[k] * here.first[k];
      curl += arm[k] * here.second[k];
    }
    distance = std::sqrt(arm2);
    radius = here.value[3];
    if (step == kNewtonSteps || distance <= 0.0) break;
    const double first = -slope / distance - here.first[3];  // derivative of distance - radius by u
    const double second = (speed2 - curl) / distance - slope * slope / (arm2 * distance) - here.second[3];
    if (second <= 0.0) break;
    const double next = std::clamp(u - std::clamp(first / second, -kLongestStep, kLongestStep), 0.0, last);
    if (next == u) break;
    u = next;
  }
  if (distance <= 0.0) return {-radius, Vec3::UnitX()};
  return {distance - radius, Vec3(arm[0] / distance, arm[1] / distance, arm[2] / distance)};
}

}  // namespace palpate::geometry
