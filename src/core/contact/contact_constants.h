#pragma once
#include <cstddef>
#include <cstdint>

/// Constants of the contact rules that act in a tick (docs/model.md, section 4): what each is, its unit, and
/// why it has this value. tools/ablate_contact measures what a hand would feel with other values
/// (docs/decisions/0029-contact-constants.md). Margins of rounding are beside their equation. Constants that
/// prepare organ and tools are in organ_arrays.h, averaged_normals.h and tool_points.cc.
namespace palpate::contact {

// Geometry.

/// Largest speed of a hand [m/s]. A faster part has jumped, for example after a device reading was lost, and
/// has no path on which it entered: at 1 kHz, 20 mm in a tick.
inline constexpr double kFastestHand = 20.0;
/// A point is inside the organ when its signed distance is below this [m]. The margin keeps rounding (about
/// 1e-16 m at the size of an organ) from moving a touching tool in and out.
inline constexpr double kInside = -1e-9;
/// A part is outside from this distance on [m]: a part that only touches counts as outside. It is far above
/// rounding and far below what a hand feels.
inline constexpr double kOutside = -1e-6;
/// Below this distance [m] the direction to the tool is rounding noise; the surface normal replaces it. It
/// concerns directions that are shown, not forces.
inline constexpr double kTouching = 1e-9;
/// Width of the patch: points within this depth of the deepest one carry the contact [m]. With a width, p*
/// moves evenly when another point becomes the deepest. It is small against the depths that a hand feels.
inline constexpr double kPatchBand = 0.2e-3;

// Start and end of a press contact.

/// An inside point up to this deep may start a contact [m], so that one grows from its first touch under a
/// part that already touches. The nearest surface of a deeper point may be the wrong side of the organ.
inline constexpr double kShallow = 0.5e-3;
/// Largest D of a second contact of a part at its start [m]. A deeper one presses tissue that the first
/// contact has already pushed aside.
inline constexpr double kDeepestSecond = 1e-3;
/// A part that loses its last contact below this distance [m] starts none until it has been outside: the
/// surface above it is unknown. A shallower part is still near the surface through which it went in.
inline constexpr double kDeepInside = -1e-3;
/// Bounds of a tick's time: patches evaluated for new contacts, and inside points tried in turn; each part.
/// All 2,000 points are tried within 63 ticks.
inline constexpr int kMaxEvaluations = 8;
inline constexpr std::uint32_t kPointsTried = 32;
/// Distance of the proxy from the patch centroid, in R_ref, above which it may be lost (decision 13). A proxy
/// that follows its patch stays well below; two contacts this close are one.
inline constexpr double kLost = 0.1;
/// Time in which a stale proxy fades out [s], so that load sharing has no step (decision 13).
inline constexpr double kFade = 100e-3;
/// Time in which held-back depth is admitted [s]: long against a tick, short against a hand's movement.
inline constexpr double kLetIn = 50e-3;

// Walk of the proxy.

/// Speed of the proxy relative to the tool [m/s]. It turns the force at an edge, or at a new deepest corner,
/// in many ticks: 50 um a tick at 1 kHz.
inline constexpr double kWalkSpeed = 0.05;
/// A shorter step ends the walk [m]. It is below what changes a force, and saves a patch.
inline constexpr double kStillStep = 0.1e-6;
/// Steps per tick. Each costs a patch; the walk converges over the ticks.
inline constexpr int kWalkSteps = 3;
/// The first step is the motion since the last walk, divided by this, so that a proxy follows a slow tool and
/// does not swing when it starts (decision 15). A step grows by half while it goes on.
inline constexpr double kRestartShare = 8.0;
/// Speed of the point of application relative to the tool [m/s]. Without it the torque steps when p* jumps
/// (decision 15).
inline constexpr double kTouchSpeed = 0.1;
/// Depth from which the damping counts in full [m], so that the first touch has no step of force.
inline constexpr double kDampingDepth = 1e-3;

// Distance cache. Results depend on none of these while the last one is large enough.

/// When more points of a cluster than this need a query, the cluster's centre is queried first: one query
/// often settles many.
inline constexpr std::size_t kFewPoints = 4;
/// When more points of a cluster than this may be the nearest one, the clearance sphere is renewed, which
/// costs one query.
inline constexpr std::size_t kFewNearer = 2;
/// Distance of the clearance sphere's centre behind the tool's nearest point [m]. So large a sphere is almost
/// a plane in front of the organ, and contains most points that are slightly farther than the nearest one.
/// With 5 mm, a tick in approach visits up to twice as many triangles at p99; 60 mm changes little.
inline constexpr double kSphereBehind = 30e-3;
/// Drift of a proxy relative to the tool that deferred clusters allow for [m/s]: twice the
/// largest.
inline constexpr double kContactDrift = 2.0 * kWalkSpeed;

// Grasp.

/// Gripper values, 0 closed to 1 open: the jaws hold below the first and let go above the second. The gap
/// keeps a trembling gripper from holding and letting go in turn.
inline constexpr double kClosedBelow = 0.3;
inline constexpr double kOpenAbove = 0.5;
/// Largest distance of a jaw from the organ at which it grasps [m]. The rest surface does
/// not rise between jaws as tissue does, so they need not touch it.
inline constexpr double kGraspReach = 1e-3;
/// Times in which the press of jaws that hold fades [s], and the pull of jaws that let go: no step of force,
/// and over before a hand can answer.
inline constexpr double kPressFade = 20e-3;
inline constexpr double kLetGoFade = 25e-3;

}  // namespace palpate::contact
