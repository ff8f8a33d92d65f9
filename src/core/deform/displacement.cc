#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/portable_math.h"
#include "core/deform/geodesic.h"
#include "core/deform/triangle_grid.h"
#include "palpate/surface.h"

namespace palpate::deform {
namespace {

constexpr double kSmallestRadius = 1e-6;  // m: R_1 of an ideal point
constexpr double kFreeShare = 0.7;        // of the thickness: up to here a press is drawn as it is
constexpr double kLargestShare = 0.9;     // of the thickness: never deeper than this
constexpr double kLeastWeight = 1e-200;   // m^8: of a vertex that hardly moves
constexpr double kOpposed = -0.3;         // cosine between two directions from which they share room in full

// Distance from a point along a direction to the first triangle that faces that way (the organ's far side);
// infinity when there is none.
double thickness_behind(const geometry::TriangleMesh& mesh, const Vec3& start, const Vec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const geometry::Triangle& t : mesh.triangles)
    nearest = std::min(nearest, way_to_far_side(mesh, t, start, direction));
  return nearest;
}

// R_1 [m] without its bound: c R (D/R)^p = c sqrt(R D) (D/R)^(p - 1/2), so that p = 1/2 is the root alone.
double contact_radius(const model::ReachParameters& reach, double depth, double tip_radius) noexcept {
  constexpr double kRoot = 0.5;
  const double root = reach.contact_ratio * std::sqrt(tip_radius * depth);
  if (reach.depth_exponent == kRoot || root == 0.0) return root;
  return root * portable::exp((reach.depth_exponent - kRoot) * portable::log(depth / tip_radius));
}

}  // namespace

double held_back(double depth, double thickness) noexcept {
  const double free = kFreeShare * thickness;
  if (depth <= free) return depth;
  const double room = (kLargestShare - kFreeShare) * thickness;
  return free + room * (depth - free) / (depth - free + room);
}

std::vector<double> shares_of_room(std::span<const Indentation> indentations) {
  std::vector<double> shares(indentations.size(), 1.0);
  for (std::size_t i = 0; i < indentations.size(); ++i) {
    for (std::size_t j = i + 1; j < indentations.size(); ++j) {
      const Indentation& a = indentations[i];
      const Indentation& b = indentations[j];
      const Vec3 between = b.point - a.point;
      const double room = between.norm();
      const double opposed = std::clamp(a.direction.dot(b.direction) / kOpposed, 0.0, 1.0);
      if (!(opposed > 0.0) || !(room > 0.0) || !(a.depth > 0.0) || !(b.depth > 0.0)) continue;
      const double nearer = (a.depth * a.direction - b.depth * b.direction).dot(between) / room;
      if (nearer <= 0.0) continue;
      const double share = 1.0 - opposed * (1.0 - held_back(nearer, room) / nearer);
      shares[i] = std::min(shares[i], share);
      shares[j] = std::min(shares[j], share);
    }
  }
  return shares;
}

double mean_direction_gain(double squared) noexcept {
  // The inverse root, and below kAlike its tangent there.
  if (squared >= kAlike) return 1.0 / std::sqrt(squared);
  return (1.5 - 0.5 * squared / kAlike) / std::sqrt(kAlike);
}

SurfaceProfile::SurfaceProfile(const model::ReachParameters& reach, double depth, double tip_radius,
                               double half_width) noexcept {
  if (!(depth > 0.0)) return;
  depth_ = depth;
  double first = contact_radius(reach, depth, std::max(0.0, tip_radius));
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
    : geodesic_(std::make_unique<GeodesicDistance>(rest)), sums_(rest.vertices.size()) {}

SurfaceDeformer::~SurfaceDeformer() = default;
SurfaceDeformer::SurfaceDeformer(SurfaceDeformer&& other) noexcept = default;
SurfaceDeformer& SurfaceDeformer::operator=(SurfaceDeformer&& other) noexcept = default;

const geometry::TriangleMesh& SurfaceDeformer::rest() const noexcept { return geodesic_->mesh(); }

void SurfaceDeformer::add(const model::ReachParameters& reach, const Indentation& indentation,
                          double rounding) {
  const SurfacePoint contact = geodesic_->nearest(indentation.point);
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
  geodesic_->compute(contact, limit);
  for (const std::int32_t v : geodesic_->reached()) {
    const double r = geodesic_->at(v);
    const Vec3 displacement =
        profile.rounded_at(r, rounding) * normal_part + side_profile.rounded_at(r, rounding) * side_part;
    const double length = displacement.norm();
    if (!(length > 0.0)) continue;
    const double squared = length * length;
    const double weight = std::max(squared * squared * squared * squared, kLeastWeight);
    Sums& sums = sums_[static_cast<std::size_t>(v)];
    if (sums.weight == 0.0) touched_.push_back(v);
    sums.weight += weight;
    sums.length += weight * length;
    sums.squares += squared;
    sums.directions += length * displacement;
  }
}

void SurfaceDeformer::deform(const model::ReachParameters& reach, std::span<const Indentation> indentations,
                             std::vector<Vec3>& vertices, double rounding) {
  vertices = rest().vertices;
  const std::vector<double> shares = shares_of_room(indentations);
  for (std::size_t i = 0; i < indentations.size(); ++i) {
    Indentation indentation = indentations[i];
    indentation.depth *= shares[i];
    if (indentation.depth > 0.0) add(reach, indentation, rounding);
  }
  for (const std::int32_t v : touched_) {
    Sums& sums = sums_[static_cast<std::size_t>(v)];
    const Vec3 direction = sums.directions / sums.squares;
    vertices[static_cast<std::size_t>(v)] +=
        sums.length / sums.weight * mean_direction_gain(direction.squaredNorm()) * direction;
    sums = {};
  }
  touched_.clear();
}

}  // namespace palpate::deform
