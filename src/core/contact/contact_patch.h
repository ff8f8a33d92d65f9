#pragma once
#include <cstdint>

#include "core/contact/tool_points.h"

namespace palpate::contact {

/// The part's points that carry a contact, in the frame of the query.
struct ContactPatch {
  double depth = 0.0;            // D [m]; 0: no point is behind the tangent plane
  Vec3 centroid = Vec3::Zero();  // p*
  double tip_radius = 0.0;       // R, weighted mean over the patch [m]
  double half_width = 0.0;       // of the part, weighted mean over the patch [m]
  std::uint32_t cluster = 0;     // of the part: that of the deepest point
};

/// [rt] The contact patch at a proxy. `point` and the unit outward `normal` are in the part's frame P. D is
/// the largest tapered depth d of a point behind the tangent plane. The taper falls from 1 to 0 between
/// R_ref/2 and R_ref from the axis. p* is the mean of the points within 0.2 mm of D, with weight area x (1 -
/// (D - d)/0.2 mm) (docs/model.md, section 4). When D < 0.2 mm the band is D, so that points enter with
/// weight 0.
/// @param guess ContactPatch::cluster of the last tick; it speeds the search up and does not change the
/// result
[[nodiscard]] ContactPatch contact_patch_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                                            double reference_radius, std::uint32_t guess = 0) noexcept;

}  // namespace palpate::contact
