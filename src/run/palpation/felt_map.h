#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/contact/contact.h"
#include "core/geometry/cell.h"
#include "palpate/tick_row.h"

namespace palpate::palpation {

/// [any] Normal component of a row's tissue force [N], without friction.
[[nodiscard]] double normal_force(const haptics::TickRow& row) noexcept;

/// What hands felt at a point of the organ's surface.
struct FeltPlace {
  // Felt normal force divided by the force of the uniform tissue at the same depths; above 1: stiffer. NaN:
  // not pressed 1 mm deep
  // for 20 ticks.
  double factor = std::numeric_limits<double>::quiet_NaN();
  double depth = 0.0;  // m, largest depth nearby
  double force = 0.0;  // N, largest normal force nearby
};

/// The map of the stiffness that hands felt, over the vertices of the organ's rest surface (organ frame). The
/// factor at a vertex v is
///
///     sum w F_n / sum w F_0(D),   w = (1 - r^2 / R^2)^2,
///
/// over all ticks whose contact c is within R of v, r = |c - v|, and at least 1 mm deep. R is the tip's
/// radius, 3 to 10 mm, F_n the normal force without the damping b dD/dt, F_0 the press law of the scene's
/// tissue, and D the depth.
class FeltMap final {
 public:
  /// [setup] @param world must outlive this
  explicit FeltMap(const contact::World& world);

  /// [any] Adds one tick of one hand; a tick without a press changes nothing. @param organ_W the organ's pose
  /// in that tick
  void add(const haptics::TickRow& row, const Pose& organ_W);

  [[nodiscard]] const geometry::TriangleMesh& surface() const noexcept { return world_.rest_surface(); }
  /// [any] @param vertex index in surface()
  [[nodiscard]] FeltPlace at(std::size_t vertex) const;
  /// [any] The factor that the tissue has at a vertex, at the mean depth of all presses, weighted by F_0;
  /// without presses at 5 mm.
  [[nodiscard]] double true_factor(std::size_t vertex) const;
  /// [any] The radius R [m] of a hand's tool.
  [[nodiscard]] double reach(std::size_t hand) const noexcept;

 private:
  struct Sums {
    double ticks = 0.0;    // sum w
    double force = 0.0;    // sum w F_n
    double uniform = 0.0;  // sum w F_0
    float deepest = 0.0F;
    float largest = 0.0F;
  };

  struct Last {
    double time = 0.0;   // s
    double depth = 0.0;  // m
  };
  /// dD/dt [m/s] since the hand's last row; NaN when it is unknown.
  [[nodiscard]] double depth_rate(const haptics::TickRow& row);

  const contact::World& world_;
  std::vector<Vec3> normals_;  // unit, per vertex
  std::unordered_map<geometry::Cell, std::vector<std::int32_t>, geometry::ThreeWordsHash>
      cells_;               // vertices by cell
  std::vector<Sums> sums_;  // per vertex
  std::vector<Last> last_;  // per hand
  double uniform_ = 0.0;    // sum F_0 over all presses [N]
  double depth_ = 0.0;      // sum F_0 D [N m]
};

}  // namespace palpate::palpation
