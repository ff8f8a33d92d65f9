#include "palpate/deform/displacement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/deform/triangle_grid.h"

namespace palpate::deform {
namespace {

constexpr double kSmallestRadius = 1e-6;  // m: R_1 of an ideal point
constexpr double kFreeShare = 0.7;        // of the thickness: up to here a press is drawn as it is
constexpr double kLargestShare = 0.9;     // of the thickness: never deeper than this
constexpr double kLeastWeight = 1e-200;   // m^8: of a vertex that hardly moves

// Distance from a point along a direction to the first triangle that faces that way (the organ's far side);
// infinity when there is none.
double thickness_behind(const geometry::TriangleMesh& mesh, const Vec3& start, const Vec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const geometry::Triangle& t : mesh.triangles)
    nearest = std::min(nearest, way_to_far_side(mesh, t, start, direction));
  return nearest;
}

}  // namespace

double held_back(double depth, double thickness) noexcept {
  const double free = kFreeShare * thickness;
  if (depth <= free) return depth;
  const double room = (kLargestShare - kFreeShare) * thickness;
  return free + room * (depth - free) / (depth - free + room);
}

SurfaceProfile::SurfaceProfile(const model::ReachParameters& reach, double depth, double tip_radius,
                               double half_width) noexcept {
  if (!(depth > 0.0)) return;
  depth_ = depth;
  double first = reach.contact_ratio * std::sqrt(std::max(0.0, tip_radius) * depth);
  if (half_width > 0.0) first = std::min(first, half_width);
  first = std::max(first, kSmallestRadius);
  double weight = 1.0;
  double weights = 0.0;
  double bars = 0.0;  // (s^(i-1) - 1)/(s - 1) = 1 + s + ... + s^(i-2)
  double bar = 1.0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    radius_[i] = first * (1.0 + reach.first_bar_ratio * bars);
    weight_[i] = weight;
    weights += weight;
    weight *= reach.weight_ratio;
    bars += bar;
    bar *= reach.bar_ratio;
  }
  for (double& w : weight_) w *= depth / weights;
}

double SurfaceProfile::at(double r) const noexcept {
  if (r <= 0.0) return depth_;
  double u = 0.0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    if (r < radius_[i]) u += weight_[i] * (1.0 - (r / radius_[i]) * (r / radius_[i]));
  }
  return u;
}

double SurfaceProfile::rounded_at(double r, double share) const noexcept {
  if (r <= 0.0 || share <= 0.0) return at(r);
  // Integral of max(0, 1 - x^2) from 0.
  const auto integral = [](double x) {
    const double inside = std::min(x, 1.0);
    return inside - inside * inside * inside / 3.0;
  };
  double u = 0.0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    const double x = r / radius_[i];
    if (x < 1e-4) {
      u += weight_[i];  // where the quotient below would lose digits
    } else if (x * (1.0 - share) < 1.0) {
      u += weight_[i] * (integral(x * (1.0 + share)) - integral(x * (1.0 - share))) / (2.0 * share * x);
    }
  }
  return u;
}

double SurfaceProfile::steepest() const noexcept {
  // Between the R_i the slope grows with r, so it is largest just inside one of them.
  double steepest = 0.0;
  for (std::size_t k = 0; k < kLayers; ++k) {
    double slope = 0.0;
    for (std::size_t i = k; i < kLayers; ++i) {
      if (radius_[i] > 0.0) slope += 2.0 * weight_[i] * radius_[k] / (radius_[i] * radius_[i]);
    }
    steepest = std::max(steepest, slope);
  }
  return steepest;
}

SurfaceProfile SurfaceProfile::widened(double factor) const noexcept {
  SurfaceProfile wide = *this;
  for (double& radius : wide.radius_) radius *= factor;
  return wide;
}

SurfaceDeformer::SurfaceDeformer(const geometry::TriangleMesh& rest)
    : geodesic_(rest), sum_(rest.vertices.size(), Vec3::Zero()), weight_(rest.vertices.size(), 0.0) {}

void SurfaceDeformer::add(const model::ReachParameters& reach, const Indentation& indentation,
                          double rounding) {
  const SurfacePoint contact = geodesic_.nearest(indentation.point);
  const double along_normal = indentation.direction.dot(contact.normal);
  double depth = indentation.depth;
  if (along_normal < 0.0)
    depth = held_back(depth, thickness_behind(rest(), contact.point, indentation.direction));
  const SurfaceProfile profile(reach, depth, indentation.tip_radius, indentation.half_width);
  const Vec3 normal_part = along_normal * contact.normal;
  const Vec3 side_part = indentation.direction - normal_part;
  const double fold = side_part.norm() * profile.steepest() / kSteepestSideways;
  const SurfaceProfile side_profile = profile.widened(std::max(1.0, fold));

  // The profile runs out at its reach, rounded at reach / (1 - rounding).
  const double limit = side_profile.reach() / (1.0 - rounding);
  geodesic_.compute(contact, limit);
  for (const std::int32_t v : geodesic_.reached()) {
    const double r = geodesic_.at(v);
    const Vec3 displacement =
        profile.rounded_at(r, rounding) * normal_part + side_profile.rounded_at(r, rounding) * side_part;
    const double length = displacement.norm();
    if (!(length > 0.0)) continue;
    const std::size_t i = static_cast<std::size_t>(v);
    const double squared = length * length;
    const double weight = std::max(squared * squared * squared * squared, kLeastWeight);
    if (weight_[i] == 0.0) touched_.push_back(v);
    sum_[i] += weight * displacement;
    weight_[i] += weight;
  }
}

void SurfaceDeformer::deform(const model::ReachParameters& reach, std::span<const Indentation> indentations,
                             std::vector<Vec3>& vertices, double rounding) {
  vertices = rest().vertices;
  for (const Indentation& indentation : indentations) {
    if (indentation.depth > 0.0) add(reach, indentation, rounding);
  }
  for (const std::int32_t v : touched_) {
    const std::size_t i = static_cast<std::size_t>(v);
    vertices[i] += sum_[i] / weight_[i];
    sum_[i].setZero();
    weight_[i] = 0.0;
  }
  touched_.clear();
}

}  // namespace palpate::deform
