#pragma once
#include <cstdint>

#include "core/contact/tool_points.h"

namespace palpate::contact {

/// Points within this of the deepest one carry the contact [m].
inline constexpr double kPatchBand = 0.2e-3;

/// What of a part lies behind the tangent plane of a contact. In the frame that was asked in.
struct ContactPatch {
  double depth = 0.0;            // D [m]; 0: nothing is behind the plane
  Vec3 centroid = Vec3::Zero();  // p*
  double tip_radius = 0.0;       // R there [m]
  double half_width = 0.0;       // of the part there [m]
  std::uint32_t cluster = 0;     // of the part's, that the deepest point is in
};

/// [rt] The patch of a contact at `point` with unit outward `normal`, both in the part's frame P: D is the
/// greatest depth behind the plane, each point's depth tapered from 1 to nothing between R_ref/2 and R_ref
/// from the axis; p* is the mean of the points within 0.2 mm of D, weight area x (1 - (D - d)/0.2 mm)
/// (model.md, section 4). Below 0.2 mm of depth the band is D itself, so that points come in with weight
/// nothing.
/// @param guess ContactPatch::cluster of a moment ago may speed it up; the answer does not depend on it
[[nodiscard]] ContactPatch contact_patch_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                                            double reference_radius, std::uint32_t guess = 0) noexcept;

}  // namespace palpate::contact
