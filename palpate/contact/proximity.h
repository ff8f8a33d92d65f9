#pragma once
#include "palpate/contact/state.h"

namespace palpate::contact {

/// A hand moves no faster than this [m/s]; a part that does has been placed anew (a reading that dropped out
/// and came back elsewhere).
inline constexpr double kFastestHand = 20.0;

/// A point is inside from here on [m]: rounding must not make a tool that just touches come and go.
inline constexpr double kInside = -1e-9;

/// [rt] Brings a part to `pose_S`: its distance to the organ, exactly, and every point that went in on the
/// way (also right through), exactly. Distances are asked only of points that may have become the nearest or
/// may have crossed the surface; the rest are bounded by how far the part has moved since they were asked.
/// @return false when the part was placed anew: no contact of before is valid, and it is off until it has
/// been outside.
bool move_part(const OrganSurface& surface, const PartPoints& points, const Pose& pose_S, double period,
               PartState& part) noexcept;

/// [rt] Bounds of a point's signed distance [m].
[[nodiscard]] inline double least_distance(const PartState& part, std::size_t point) noexcept {
  return part.known[point] - (part.travelled - part.since[point]);
}
[[nodiscard]] inline double greatest_distance(const PartState& part, std::size_t point) noexcept {
  return part.known[point] + (part.travelled - part.since[point]);
}

/// [rt] Asks a point's distance now and keeps it.
geometry::NearestPoint ask_distance(const OrganSurface& surface, const PartPoints& points, std::size_t point,
                                    PartState& part) noexcept;

/// [rt] How far the part's material at `point_S` (where it is now) has moved in this tick [m].
[[nodiscard]] inline Vec3 motion_at(const PartState& part, const Vec3& point_S) noexcept {
  const Vec3 point_P = part.pose_S.inverse() * point_S;
  return part.pose_S * point_P - part.previous_S * point_P;  // exactly 0 at rest
}

}  // namespace palpate::contact
