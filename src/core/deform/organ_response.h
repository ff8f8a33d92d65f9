#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/deform/body_compliance.h"
#include "core/deform/cell_pieces.h"
#include "palpate/mesh.h"
#include "palpate/support.h"

namespace palpate::deform {

/// How a whole organ moves under forces on its surface. Young's modulus is 1; it cancels where depths are
/// given. All functions are [any] and const; one response serves all threads.
class OrganResponse final {
 public:
  using Displacements = std::vector<Eigen::Vector4f>;  // one per spline [m/N]; fourth entry 0

  /// Nodes on which a force at a place of the surface acts, with their shares (sum 1).
  struct Load {
    std::vector<std::pair<std::int32_t, float>> shares;  // node, share
    Vec3 normal = Vec3::Zero();                          // mean outward normal there, unit
  };

  /// [setup] As prepare_response().
  OrganResponse(const geometry::TriangleMesh& organ, const geometry::Support& support,
                const contact::OrganStore* store = nullptr);

  [[nodiscard]] const CellPieces& pieces() const noexcept { return body_.pieces; }
  /// Distance over which cells with this edge spread a force [m]; a smaller contact needs the half-space's
  /// field in addition. The less that adds, the better on a curved or thin organ, but splines do not resolve
  /// much less than a cell, which counts for contacts of 4 mm beside cells of 8 mm.
  [[nodiscard]] static double spread(double edge) noexcept {
    return std::clamp(kSpread, kLeastSpread * edge, edge);
  }

  /// A force spread like Hertz's pressure over the surface within `radius` [m] of a point on the side that
  /// `normal` faces. @param point on the surface [m] @param normal outward, unit
  [[nodiscard]] Load load_at(const Vec3& point, const Vec3& normal, double radius) const;

  /// The displacements under a unit force along each axis on a load.
  [[nodiscard]] std::array<Displacements, 3> under(const Load& load) const;

  /// Work of a force on a load in a displacement field [N m].
  [[nodiscard]] double work(const Load& load, const Eigen::Vector3f& force, const Displacements& field) const;

  /// Displacements without any force.
  [[nodiscard]] Displacements none() const;

  /// The displacement at a place [m].
  [[nodiscard]] Vec3 at(const Displacements& field, const CellPieces::Place& place) const noexcept;

 private:
  static constexpr double kSpread = 8e-3;      // m
  static constexpr double kLeastSpread = 0.6;  // of a cell
  struct SurfacePart {
    Vec3 point = Vec3::Zero();  // [m]
    Vec3 area = Vec3::Zero();   // area vector, outwards [m^2]
    CellPieces::Place place;
  };
  void gather_surface(const geometry::TriangleMesh& organ);

  BodyCompliance body_;
  std::vector<std::int32_t> first_part_;  // per cell: its parts in parts_; one more at the end
  std::vector<SurfacePart> parts_;        // sorted by cell
};

}  // namespace palpate::deform
