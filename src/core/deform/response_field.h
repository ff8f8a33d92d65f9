#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/index.h"
#include "core/deform/near_field.h"
#include "core/deform/organ_response.h"
#include "palpate/pose.h"

namespace palpate::deform {

/// The displacement of a whole organ under several contacts, each with its own depth.
class ResponseField final {
 public:
  struct Contact {
    Vec3 point = Vec3::Zero();         // on the rest surface [m]
    Vec3 normal = Vec3::Zero();        // outward, unit
    Vec3 displacement = Vec3::Zero();  // of the surface there [m]
    double tip_radius = 0.0;           // of the tool [m]
    double curvature = 0.0;            // of the rest surface under the tool, convex positive [1/m]
  };
  /// Where a vertex lies.
  struct Place {
    std::uint32_t piece = 0;
    std::array<float, 3> within{};  // of the piece's cell
  };

  /// [setup]
  explicit ResponseField(std::shared_ptr<const OrganResponse> response);

  /// [setup] The field under these contacts only. A press (a displacement against the normal) may push and
  /// not pull, and moves freely sideways unless its displacement has a part along the surface.
  /// @param share factor of the whole field
  void set(std::span<const Contact> contacts, float share = 1.0F);

  [[nodiscard]] bool is_zero() const noexcept { return contacts_.empty(); }
  /// [any] Share of the wanted displacement that contact i lacks, 0 to 1: above 0 only where the support
  /// holds the surface under the tool.
  [[nodiscard]] double missing(std::size_t i) const noexcept { return missing_[i]; }
  /// [any] How much the displacement of a spline changed in the last set() [m].
  [[nodiscard]] float change(std::int32_t spline) const noexcept { return change_[palpate::at(spline)]; }
  /// [any] How the fields near contacts changed in the last set().
  [[nodiscard]] std::span<const NearFieldChange> near_changes() const noexcept { return near_changes_; }
  /// [any] Splines of a piece of the organ, and their weights at a place in its cell.
  [[nodiscard]] const CellPieces::Splines& splines_of(std::uint32_t piece) const noexcept {
    return response_->pieces().pieces()[piece].splines;
  }
  [[nodiscard]] static std::array<float, CellGrid::kNodesOfCell> weights_of(const Place& place) noexcept;
  /// [any] Place of a rest vertex, for at().
  [[nodiscard]] Place place_of(const Vec3& vertex, const Vec3& outward) const noexcept;
  /// [any] Motion of a rest vertex.
  [[nodiscard]] PlaceMotion at(const Eigen::Vector3f& vertex, const Place& place) const noexcept;

  /// The field of one piece as a polynomial of the place in its cell: the coefficient of x^a y^b z^c of each
  /// component at [a][b][c], in all four lanes.
  struct CellPolynomial {
    std::array<std::array<std::array<Float4x3, 3>, 3>, 3> of;
    float edge = 0.0F;  // of the cell [m]
  };
  /// [any] The field of one piece.
  void take_polynomial(std::uint32_t piece, CellPolynomial& cell) const noexcept;
  /// [any] Motions of four rest vertices in one cell. @param within their places in the cell
  [[nodiscard]] FourMotions at(const CellPolynomial& cell, const Float4x3& within,
                               const Float4x3& vertices) const noexcept;

 private:
  // The field of one contact under unit forces along the axes.
  struct Columns {
    Contact contact;
    CellPieces::Place place;  // of the contact
    double spread = 0.0;      // radius over which the cells' force is spread [m]
    double radius = 0.0;      // of the contact [m]
    OrganResponse::Load load;
    std::array<OrganResponse::Displacements, 3> along;
    NearField near;             // under the force times the field's share
    Vec3 force = Vec3::Zero();  // [N at Young's modulus 1]
  };
  [[nodiscard]] Columns columns_for(const Contact& contact, const CellPieces::Place& place,
                                    double spread) const;
  void set_radius(Columns& columns) const;
  [[nodiscard]] Eigen::Matrix3d response(const Columns& from, const Columns& to) const;
  void solve_presses();
  void solve_sides();
  void sum_up(float share);
  void compare_near(std::span<const NearField> before);

  std::shared_ptr<const OrganResponse> response_;
  std::vector<Columns> contacts_;
  std::vector<Columns> before_;
  Eigen::MatrixXd between_;  // 3 rows a contact: displacement under unit forces of all
  std::vector<double> missing_;
  OrganResponse::Displacements field_;
  std::vector<float> change_;  // per spline [m]
  std::vector<NearFieldChange> near_changes_;
};

}  // namespace palpate::deform
