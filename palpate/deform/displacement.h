#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/geometry/mesh.h"
#include "palpate/model/tissue.h"

namespace palpate::deform {

/// One place where a tool presses or pulls the surface, in the organ's frame.
struct Indentation {
  Vec3 point = Vec3::Zero();      // on the rest surface [m]
  Vec3 direction = Vec3::Zero();  // unit: where the surface goes
  double depth = 0.0;             // D [m], u(0) = D
  double tip_radius = 0.0;        // R [m]
  double half_width = 0.0;        // of the tool there [m]: R_1 is never more; 0: no bound
};

/// The surface profile u(r) around one contact (model.md, section 3).
class SurfaceProfile final {
 public:
  static constexpr int kLayers = 6;
  /// [any] @param reach checked by model::validate
  SurfaceProfile(const model::ReachParameters& reach, double depth, double tip_radius,
                 double half_width = 0.0) noexcept;
  /// [rt] Displacement [m] at distance r [m] along the surface.
  [[nodiscard]] double at(double r) const noexcept;
  /// [rt] Beyond this distance [m] nothing moves.
  [[nodiscard]] double reach() const noexcept;

 private:
  std::array<double, kLayers> inverse_radius_squared_{};
  std::array<double, kLayers> weight_{};  // [m]
};

/// Moves a surface's vertices around contacts; r is measured along the surface.
class SurfaceDeformer final {
 public:
  /// [setup] Precomputes adjacency of the rest mesh (kept by copy).
  explicit SurfaceDeformer(const geometry::TriangleMesh& rest);

  /// Displaced vertices under all indentations together; as many as the rest mesh has, organ frame. Not [rt]:
  /// runs on the picture's thread. Only vertices in reach are touched.
  void deform(const model::ReachParameters& reach, std::span<const Indentation> indentations,
              std::vector<Vec3>& vertices);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept { return rest_; }

 private:
  geometry::TriangleMesh rest_;
  std::vector<std::int32_t> neighbour_start_;
  std::vector<std::int32_t> neighbours_;
  std::vector<double> distance_;
  std::vector<std::int32_t> touched_;
};

}  // namespace palpate::deform
