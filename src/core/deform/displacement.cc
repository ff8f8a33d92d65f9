// How the surface around a contact moves: the displacement profile u(r), and the rules that keep a deep
// press inside the organ. docs/model.md, section 3, has the formula; the paper has none.
//
// In the paper's spring network, a cross bar below each spring carries four springs of the next layer. So
// layer i spreads over a wider circle than layer i - 1. The profile is a sum of six paraboloids, one for
// each layer. All have their top at the contact, and each has its own radius R_i and weight w_i:
//
//     u/D
//      1 |*                                   u(r) = D sum_i w_i max(0, 1 - (r/R_i)^2)
//        | *
//        |  *                                 narrow layers: the pit under the tip;
//        |   **                               wide ones: the long slope around it.
//        |     ***
//        |        ******
//      0 +---+----+----+--------************---- r, along the surface
//           R_1  R_2  R_3  ...           R_6
//
// - R_1 = c R (D/R)^p follows the radius of contact of a ball of radius R; with p = 1/2 it is c sqrt(R D).
//   The steps from R_1 to R_6 form a geometric series.
// - The weights fall by the factor g from layer to layer. Their sum is 1, so that u(0) = D.
// - u(r) has a corner in its slope at each R_i. Light would show them as rings. rounded_at() averages u
//   over a band of relative width `share` about r, from the integral of each paraboloid.
//
// A profile is for one contact. SurfaceDeformer (palpate/surface.h) blends several, with distances r along
// the surface. Two rules limit the depth that is drawn; the force does not know them:
//
//     drawn depth
//     0.9 |- - - - - - - - - -
//         |           ..-----       depths relative to the organ's thickness
//     0.7 |        .-'
//         |     .'
//         |  .'
//         +-------+--------- depth
//                0.7
//
// limited_depth() draws a press unchanged up to 0.7 of the thickness. Deeper presses follow a hyperbola
// with the same slope at the joint, which stays below 0.9 for any depth. So the pressed side never comes
// out of the far side. opposition_factors() does this for two presses from opposite sides, with the
// distance of their contacts as thickness. The sum of their depths is limited, and both are lowered by one
// factor. The rule sets in gradually with the angle between the presses.

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/index.h"
#include "core/base/portable_math.h"
#include "core/deform/deformed_surface.h"
#include "palpate/surface.h"

namespace palpate::deform {
namespace {

constexpr double kSmallestRadius = 1e-6;  // m; smallest R_1, of a point contact
constexpr double kFreeShare = 0.7;        // of the thickness: shallower presses are not limited
constexpr double kLargestShare = 0.9;     // of the thickness: bound of the limited depth
// cosine between two directions below which opposed indentations are limited in full
constexpr double kOpposed = -0.3;

// R_1 [m] before its bound: c R (D/R)^p = c sqrt(R D) (D/R)^(p - 1/2), so that p = 1/2 needs the square root
// only.
double contact_radius(const model::FalloffRatios& reach, double depth, double tip_radius) noexcept {
  constexpr double kRoot = 0.5;
  const double root = reach.contact_ratio * std::sqrt(tip_radius * depth);
  if (reach.depth_exponent == kRoot || root == 0.0) return root;
  return root * portable::exp((reach.depth_exponent - kRoot) * portable::log(depth / tip_radius));
}

}  // namespace

double limited_depth(double depth, double thickness) noexcept {
  const double free = kFreeShare * thickness;
  if (depth <= free) return depth;
  const double room = (kLargestShare - kFreeShare) * thickness;
  return free + room * (depth - free) / (depth - free + room);
}

std::vector<double> opposition_factors(std::span<const Indentation> indentations) {
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
      const double share = 1.0 - opposed * (1.0 - limited_depth(nearer, room) / nearer);
      shares[i] = std::min(shares[i], share);
      shares[j] = std::min(shares[j], share);
    }
  }
  return shares;
}

double mean_direction_gain(double squared) noexcept {
  // The inverse square root; below kAlike its tangent at kAlike.
  if (squared >= kAlike) return 1.0 / std::sqrt(squared);
  return (1.5 - 0.5 * squared / kAlike) / std::sqrt(kAlike);
}

DisplacementProfile::DisplacementProfile(const model::FalloffRatios& reach, double depth, double tip_radius,
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

double DisplacementProfile::at(double r) const noexcept {
  if (r <= 0.0) return depth_;
  double u = 0.0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    if (r < radius_[i]) u += weight_[i] * (1.0 - (r / radius_[i]) * (r / radius_[i]));
  }
  return u;
}

double DisplacementProfile::rounded_at(double r, double share) const noexcept {
  if (r <= 0.0 || share <= 0.0) return at(r);
  // Integral of max(0, 1 - t^2) from 0 to x.
  const auto integral = [](double x) {
    const double inside = std::min(x, 1.0);
    return inside - inside * inside * inside / 3.0;
  };
  double u = 0.0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    const double x = r / radius_[i];
    if (x < 1e-4) {
      u += weight_[i];  // the quotient below would lose digits
    } else if (x * (1.0 - share) < 1.0) {
      u += weight_[i] * (integral(x * (1.0 + share)) - integral(x * (1.0 - share))) / (2.0 * share * x);
    }
  }
  return u;
}

double DisplacementProfile::steepest() const noexcept {
  // Between the R_i the slope grows with r, so its maximum is just inside one of them.
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

DisplacementProfile DisplacementProfile::widened(double factor) const noexcept {
  DisplacementProfile wide = *this;
  for (double& radius : wide.radius_) radius *= factor;
  return wide;
}

SurfaceDeformer::SurfaceDeformer(geometry::TriangleMesh rest, std::shared_ptr<const OrganResponse> response)
    : response_(std::move(response)),
      surface_(std::make_unique<DeformedSurface>(std::move(rest), reach_, 0.0, 0.0F)) {
  surface_->set_response(response_);
}

SurfaceDeformer::~SurfaceDeformer() = default;
SurfaceDeformer::SurfaceDeformer(SurfaceDeformer&& other) noexcept = default;
SurfaceDeformer& SurfaceDeformer::operator=(SurfaceDeformer&& other) noexcept = default;

const geometry::TriangleMesh& SurfaceDeformer::rest() const noexcept { return surface_->rest(); }

void SurfaceDeformer::deform(const model::FalloffRatios& reach, std::span<const Indentation> indentations,
                             std::vector<Vec3>& vertices) {
  if (!(reach == reach_)) {
    reach_ = reach;
    surface_ = std::make_unique<DeformedSurface>(rest(), reach, 0.0, 0.0F);
    surface_->set_response(response_);
  }
  surface_->update(indentations, DeformedSurface::kSettle);
  vertices = rest().vertices;
  for (const std::int32_t v : surface_->moved()) {
    const Eigen::Vector3f displacement =
        surface_->vertices()[at(v)].position - surface_->rest_vertices()[at(v)];
    vertices[at(v)] += displacement.cast<double>();
  }
}

}  // namespace palpate::deform
