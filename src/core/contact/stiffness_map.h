#pragma once
#include <span>
#include <vector>

#include "core/contact/organ_surface.h"
#include "palpate/inclusion.h"

namespace palpate::contact {

/// Factor of the tissue's stiffness over the rest surface. Within a triangle it is the quadratic
/// sum b_v (k_v + g_v . (c - v)) of the values k_v and gradients g_v at its corners, with b_v the barycentric
/// coordinates: continuous, with nearly continuous gradient.
class StiffnessMap final {
 public:
  /// The factor is 1 everywhere.
  StiffnessMap() = default;
  /// [setup] Interpolates ln k along the surface between the given points: the smoothest function through
  /// them. @param store keeps the interpolated values, which take seconds on a fine organ; null: none
  /// @throws as model::validate(); InputError for a point farther than model::kFarthestStiffnessPoint
  /// from the surface.
  StiffnessMap(const OrganSurface& surface, std::span<const model::StiffnessPoint> points,
               const OrganStore* store = nullptr);

  /// [setup] Hash of everything that the values depend on.
  [[nodiscard]] static ContentHash key(const geometry::TriangleMesh& refined,
                                       std::span<const model::StiffnessPoint> points);

  [[nodiscard]] bool empty() const noexcept { return values_.empty(); }

  struct Factor {
    double value = 1.0;
    Vec3 gradient_S = Vec3::Zero();  // along the surface [1/m]
  };
  /// [rt] The factor at a point of the rest surface.
  [[nodiscard]] Factor factor_at(const SurfacePoint& place) const noexcept;

  /// Largest values over a triangle's corners.
  struct Steepness {
    double value = 1.0;      // factor k
    double slope = 0.0;      // |dk/dc| [1/m]
    double curvature = 0.0;  // |d2k/dc2|, of the gradients at two corners over their distance [1/m^2]
  };
  /// [any] @param triangle of the refined rest surface
  [[nodiscard]] Steepness steepness_of(std::int32_t triangle) const noexcept;

 private:
  void set_gradients();

  const OrganSurface* surface_ = nullptr;
  std::vector<double> values_;   // per vertex
  std::vector<Vec3> gradients_;  // per vertex [1/m]
};

}  // namespace palpate::contact
