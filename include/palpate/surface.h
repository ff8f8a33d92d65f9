#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/tissue.h"
#include "palpate/tool_contact.h"

namespace palpate::deform {

class DeformedSurface;

/// One place where a tool presses or pulls the surface, in the organ's frame.
struct Indentation {
  Vec3 point = Vec3::Zero();      // on the rest surface [m]
  Vec3 direction = Vec3::Zero();  // unit: where the surface goes
  double depth = 0.0;             // D [m], u(0) = D
  double tip_radius = 0.0;        // R [m]
  double half_width = 0.0;        // of the tool there [m]: R_1 is never more; 0: no bound
};

/// The surface profile u(r) around one contact (model.md, section 3):
/// u(r) = D sum_i w_i max(0, 1 - (r/R_i)^2), w_i proportional to g^(i-1), R_1 = c R (D/R)^p,
/// R_i = R_1 (1 + a (s^(i-1) - 1)/(s - 1)), i = 1..6. At every r it grows with D.
class DisplacementProfile final {
 public:
  static constexpr int kLayers = 6;
  /// [any] @param reach checked by model::validate
  /// @param depth D [m]; <= 0 (or NaN): nothing moves
  /// @param tip_radius R [m]; @param half_width bound of R_1 [m], 0: none
  DisplacementProfile(const model::FalloffRatios& reach, double depth, double tip_radius,
                      double half_width = 0.0) noexcept;
  /// [rt] Displacement [m] at distance r [m] along the surface. at(0) is D exactly.
  [[nodiscard]] double at(double r) const noexcept;
  /// [rt] The mean of u over r (1 - share) .. r (1 + share): the same depth at r = 0, but without the corners
  /// that u has at each R_i, which a light would show as rings.
  [[nodiscard]] double rounded_at(double r, double share) const noexcept;
  /// [rt] Beyond this distance [m] nothing moves (R_6; 0 when D <= 0).
  [[nodiscard]] double outer_radius() const noexcept { return radius_[kLayers - 1]; }
  /// [rt] Largest |du/dr|, without unit.
  [[nodiscard]] double steepest() const noexcept;
  /// [rt] The same depth with every R_i `factor` times as long.
  [[nodiscard]] DisplacementProfile widened(double factor) const noexcept;

 private:
  double depth_ = 0.0;                    // D [m]
  std::array<double, kLayers> radius_{};  // R_i [m]
  std::array<double, kLayers> weight_{};  // D w_i [m]
};

/// Slope of a displacement that lies in the surface, at most; 1 would fold the surface.
inline constexpr double kMaxTangentialSlope = 0.8;

/// [any] Depth [m] of a press as drawn in front of a surface `thickness` [m] behind: itself up to 0.7 of it,
/// then smoothly to 0.9.
[[nodiscard]] double limited_depth(double depth, double thickness) noexcept;

/// [any] For each indentation the factor, at most 1, by which it is drawn shallower because another one comes
/// towards it from the opposite side: where two directions differ by over 90 degrees, the way by which they
/// shorten the distance between their contacts is limited_depth() in that distance; in full from 107 degrees
/// on.
[[nodiscard]] std::vector<double> opposition_factors(std::span<const Indentation> indentations);

/// Squared length of a mean of directions from which it is made a unit vector.
inline constexpr double kAlike = 0.64;
/// [any] By what a mean of unit vectors is multiplied to be one itself, `squared` being its squared length.
/// Directions that oppose one another (below kAlike) are left shorter, so that nothing jumps between them.
[[nodiscard]] double mean_direction_gain(double squared) noexcept;

/// Moves a surface's vertices around contacts; r is measured along the surface, so the far side of a thin
/// organ stays still.
///
/// A contact moves a vertex by u(r) along its direction. Three rules beyond model.md keep the picture whole:
/// - The part of a displacement that lies in the surface (a pull to the side) is spread wide enough that its
///   slope stays below 0.8: the surface ahead of the contact is crowded, never folded over.
/// - Several contacts: the length is the mean of their displacements' lengths, weighted by eighth powers, the
///   direction that of the mean of their directions, weighted by squares (mean_direction_gain). So coincident
///   contacts act as one, where they overlap the largest one rules to 3 %, nothing jumps as they part, and
///   the crest between two that converge turns from one direction to the other slowly enough not to fold.
/// - A press deeper than 0.7 of the organ's thickness at the contact is drawn shallower, at most 0.9 of it:
///   the entry side never comes out of the far side. Two that press towards one another from opposite sides
///   share what lies between them in the same way (opposition_factors). Elsewhere u(0) = D.
class SurfaceDeformer final {
 public:
  /// [setup] Prepares the rest mesh, which is kept. It may be open.
  explicit SurfaceDeformer(geometry::TriangleMesh rest);
  ~SurfaceDeformer();
  SurfaceDeformer(SurfaceDeformer&& other) noexcept;
  SurfaceDeformer& operator=(SurfaceDeformer&& other) noexcept;

  /// [setup] Displaced vertices under all indentations together, to single precision; as many as the rest
  /// mesh has, organ frame. For the picture's thread. Vertices out of reach equal the rest bit for bit. The
  /// result does not depend on what was before.
  void deform(const model::FalloffRatios& reach, std::span<const Indentation> indentations,
              std::vector<Vec3>& vertices);

  [[nodiscard]] const geometry::TriangleMesh& rest() const noexcept;

 private:
  model::FalloffRatios reach_;  // that the surface is made for
  std::unique_ptr<DeformedSurface> surface_;
};

/// [setup] Where the tools of all hands press or pull the organ at one tick, organ frame.
///
/// A tip is drawn no blunter than it is wide: R is the smaller of its radius of curvature and its half-width
/// there. The bound of R_1 itself (Indentation::half_width) is not used: a ball's half-width is its radius,
/// and R_1 so bounded would cut the drawn surface through a ball that is pressed deeper than its radius; in
/// the finite-element runs that the profile was fitted to, R_1 reaches 1.56 R at D = 2 R.
/// @param results one a hand (haptics::Snapshot::hand_results)
[[nodiscard]] std::vector<Indentation> indentations_of(std::span<const contact::ToolResult> results);

}  // namespace palpate::deform
