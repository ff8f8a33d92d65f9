#pragma once
#include <limits>

#include "core/contact/state.h"

namespace palpate::contact {

/// A hand moves no faster than this [m/s]; a part that does has been placed anew (a reading that dropped out
/// and came back elsewhere).
inline constexpr double kFastestHand = 20.0;

/// A point is inside from here on [m]: rounding must not make a tool that just touches come and go.
inline constexpr double kInside = -1e-9;

/// [rt] Brings a part to `pose_S` and finds, exactly, every point that went in on the way (also right
/// through). Distances are asked only of points that may have crossed the surface; the rest are bounded by
/// how far the part has moved since they were asked. Where a contact is within R_ref none is looked for: it
/// would start no other (model.md, section 4).
/// @return false when the part was placed anew: no contact of before is valid, and it is off until it has
/// been outside.
bool move_part(const OrganSurface& surface, const PartPoints& points, const Pose& pose_S,
               double reference_radius, double period, PartState& part) noexcept;

/// [rt] Finds the part's point nearest to the organ (the deepest, when some are inside), exactly:
/// part.nearest and part.nearest_point. Again only points that may be it are asked.
/// @param enough only what is nearer than this [m] is wanted: of a part that is not, part.nearest is some
/// point that is no nearer
void find_nearest(const OrganSurface& surface, const PartPoints& points, PartState& part,
                  double enough = std::numeric_limits<double>::infinity()) noexcept;

/// [rt] Bounds of the signed distance [m] of a point that was outside (the least) or inside (the greatest)
/// when last asked; of the other kind they only keep their side of 0.
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
  const Vec3 point_P = part.placed_S.bring_back(point_S);
  return part.placed_S * point_P - part.previous_S * point_P;  // exactly 0 at rest
}

}  // namespace palpate::contact
