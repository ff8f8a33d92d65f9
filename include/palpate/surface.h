#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/preparation.h"
#include "palpate/support.h"
#include "palpate/tissue.h"
#include "palpate/tool_contact.h"

namespace palpate::deform {

class DeformedSurface;
class OrganResponse;

/// [setup] The response of an organ to forces on its surface, from its shape and what holds it. With it,
/// SurfaceDeformer moves the whole organ (docs/support.md). Takes about 0.4 s of processor time, on all
/// processors, and 9 MB. It never changes and may be shared between threads.
/// @param organ closed, outwards @param store keeps responses for later: that of scene::use_organ_cache(), or
/// null @throws InputError, ParameterError as geometry::check_support()
[[nodiscard]] std::shared_ptr<const OrganResponse> prepare_response(
    const geometry::TriangleMesh& organ, const geometry::Support& support,
    const contact::OrganStore* store = nullptr);

/// [setup] As above; null when nothing is known to hold the organ.
[[nodiscard]] inline std::shared_ptr<const OrganResponse> prepare_response(
    const geometry::TriangleMesh& organ, const std::optional<geometry::Support>& support,
    const contact::OrganStore* store = nullptr) {
  return support ? prepare_response(organ, *support, store) : nullptr;
}

/// How finely prepare_response() computes an organ.
struct ResponseCells {
  double edge = 0.0;        // of its cells [m]; half of it where the organ is thin
  double thin_share = 0.0;  // of its area, on parts thinner than their cells, whose motion is not reliable
};
/// [setup] @param organ closed, outwards
[[nodiscard]] ResponseCells response_cells(const geometry::TriangleMesh& organ);
/// [setup] A sentence for users: the cells' size, and how much of the surface is on parts too thin for them.
[[nodiscard]] std::string describe(const ResponseCells& cells);

/// Displaced surface of one contact, in the organ's frame: a tool presses or pulls the surface there.
struct Indentation {
  Vec3 point = Vec3::Zero();      // on the rest surface [m]
  Vec3 direction = Vec3::Zero();  // unit vector along which the surface moves
  double depth = 0.0;             // D [m], displacement at the contact: u(0) = D
  double tip_radius = 0.0;        // R [m], radius of curvature of the tool tip
  double half_width = 0.0;  // half-width of the tool at the contact [m], upper bound of R_1; 0: no bound

  bool operator==(const Indentation&) const = default;
};

/// Displacement profile u(r) around one contact (docs/model.md, section 3):
/// u(r) = D sum_i w_i max(0, 1 - (r/R_i)^2), w_i proportional to g^(i-1), R_1 = c R (D/R)^p,
/// R_i = R_1 (1 + a (s^(i-1) - 1)/(s - 1)), i = 1..6. At every r, u increases with D.
class DisplacementProfile final {
 public:
  static constexpr int kLayers = 6;
  /// [any] @param reach falloff ratios, validated by model::validate()
  /// @param depth D [m]; <= 0 or NaN: no displacement
  /// @param tip_radius R [m] @param half_width upper bound of R_1 [m]; 0: no bound
  DisplacementProfile(const model::FalloffRatios& reach, double depth, double tip_radius,
                      double half_width = 0.0) noexcept;
  /// [rt] Displacement [m] at a distance r [m] along the surface. at(0) is exactly D.
  [[nodiscard]] double at(double r) const noexcept;
  /// [rt] Mean [m] of u over r (1 - share) .. r (1 + share). The value at r = 0 is still D. The mean has no
  /// corners at the R_i; the corners of u would appear as rings in a picture.
  [[nodiscard]] double rounded_at(double r, double share) const noexcept;
  /// [rt] Distance [m] beyond which the displacement is 0 (R_6; 0 when D <= 0).
  [[nodiscard]] double outer_radius() const noexcept { return radius_[kLayers - 1]; }
  /// [rt] Largest |du/dr|, dimensionless.
  [[nodiscard]] double steepest() const noexcept;
  /// [rt] A profile with the same depth, whose R_i are `factor` times as large.
  [[nodiscard]] DisplacementProfile widened(double factor) const noexcept;

 private:
  double depth_ = 0.0;                    // D [m]
  std::array<double, kLayers> radius_{};  // R_i [m]
  std::array<double, kLayers> weight_{};  // D w_i [m]
};

/// Largest slope of a tangential displacement, dimensionless. A slope of 1 would fold the surface.
inline constexpr double kMaxTangentialSlope = 0.8;

/// [any] Drawn depth [m] of a press where the organ is `thickness` [m] thick. The depth is unchanged up to
/// 0.7 of the thickness. Above, it rises smoothly towards 0.9 of the thickness.
[[nodiscard]] double limited_depth(double depth, double thickness) noexcept;

/// [any] One factor (at most 1) per indentation, by which its drawn depth is reduced because another
/// indentation comes from the opposite side. The rule applies where two directions differ by more than 90
/// degrees, and fully from 107 degrees on. It limits the sum of both displacements along the line between the
/// contacts to limited_depth(), with the distance of the contacts as thickness.
[[nodiscard]] std::vector<double> opposition_factors(std::span<const Indentation> indentations);

/// Squared length of a mean of unit vectors from which on the mean is normalized to length 1.
inline constexpr double kAlike = 0.64;
/// [any] Factor that normalizes a mean of unit vectors, whose squared length is `squared`. Below kAlike the
/// directions oppose each other; the factor then leaves the mean shorter than 1, so that the displacement
/// between the contacts has no jump.
[[nodiscard]] double mean_direction_gain(double squared) noexcept;

/// Displaces the vertices of a surface around contacts. The distance r is geodesic, so the far side of a thin
/// organ does not move.
///
/// A contact moves a vertex by u(r) along the contact's direction. Three rules beyond docs/model.md keep the
/// drawn surface free of folds and self-intersections:
/// - A tangential displacement (a pull to the side) is widened until its slope is below kMaxTangentialSlope.
///   The surface ahead of the contact is compressed, but does not fold.
/// - For several contacts, the length of the displacement is the mean of their lengths, weighted by the
///   eighth powers of the lengths. The direction is the mean of their directions, weighted by the squares of
///   the lengths (mean_direction_gain). Coincident contacts therefore act as one contact. Where contacts
///   overlap, the largest displacement determines the result within 3 %. The displacement has no jump when
///   contacts separate. Between two converging contacts the direction turns slowly enough that the surface
///   does not fold.
/// - A press that is deeper than 0.7 of the organ's thickness at the contact is drawn with less depth, at
///   most 0.9 of the thickness (limited_depth). The pressed side therefore never comes out of the far side.
///   Two presses from opposite sides are limited together (opposition_factors). In all other cases u(0) = D.
///
/// With an OrganResponse the contacts' displacements add up instead, and each contact reaches its depth
/// exactly under all others. The last rule holds as well.
class SurfaceDeformer final {
 public:
  /// [setup] Prepares the rest mesh and keeps it. The mesh may be open.
  /// @param response of the organ that the mesh shows: the whole organ then gives way, bends and bulges
  /// instead of the surface around the contacts alone; null: the displacement profile
  explicit SurfaceDeformer(geometry::TriangleMesh rest,
                           std::shared_ptr<const OrganResponse> response = nullptr);
  ~SurfaceDeformer();
  SurfaceDeformer(SurfaceDeformer&& other) noexcept;
  SurfaceDeformer& operator=(SurfaceDeformer&& other) noexcept;

  /// [setup] Computes the displaced vertices under all indentations, in single precision. Call it from the
  /// thread that draws. Vertices beyond the outer radius of every profile equal the rest mesh bit for bit.
  /// The result does not depend on earlier calls. @param vertices receives one position [m] per vertex of the
  /// rest mesh, organ frame
  void deform(const model::FalloffRatios& reach, std::span<const Indentation> indentations,
              std::vector<Vec3>& vertices);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept;

 private:
  model::FalloffRatios reach_;  // for which surface_ is prepared
  std::shared_ptr<const OrganResponse> response_;
  std::unique_ptr<DeformedSurface> surface_;
};

/// [setup] Indentations of all hands at one tick, organ frame.
///
/// R is the smaller of the tip's radius of curvature and its half-width at the contact. The bound of R_1
/// (Indentation::half_width) is not set. The half-width of a ball is its radius; with this bound the drawn
/// surface would cut through a ball that is pressed deeper than its radius. In the finite-element results
/// that the profile was fitted to, R_1 reaches 1.56 R at D = 2 R.
/// @param results one per hand (haptics::Snapshot::hand_results)
[[nodiscard]] std::vector<Indentation> indentations_of(std::span<const contact::ToolResult> results);

}  // namespace palpate::deform
