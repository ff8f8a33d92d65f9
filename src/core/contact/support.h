#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/tool_points.h"

namespace palpate::contact {

/// Points within this of the deepest one carry the contact [m].
inline constexpr double kSupportBand = 0.2e-3;

/// What of a part lies behind the tangent plane of a contact. In the frame that was asked in.
struct Support {
  double depth = 0.0;        // D [m]; 0: nothing is behind the plane
  Vec3 mean = Vec3::Zero();  // p*
  double tip_radius = 0.0;   // R there [m]
  double half_width = 0.0;   // of the part there [m]
};

/// The points of a part that may carry a contact, kept while its plane stays near to the one that they were
/// found for: the next tick's support then looks at few points instead of all.
struct Shortlist {
  static constexpr std::size_t kMost = 256;  // a tool of 97,000 triangles has up to 132

  Vec3 point = Vec3::Zero();  // of the plane, in the part's frame P
  Vec3 normal = Vec3::UnitZ();
  double rest = 0.0;        // no other point had a greater depth [m]
  double rest_aside = 0.0;  // ... nor one that is farther than R_ref/2 from the axis a greater one than this
  double reach = 0.0;       // no point of the part was farther from `point` [m]
  double behind = 0.0;      // no point beside the axis was farther behind the plane [m]
  double aside = 0.0;       // no point of the list was farther from the axis [m]
  std::uint32_t count = 0;  // 0: nothing is kept
  std::array<std::uint16_t, kMost> points{};
};

/// [rt] The support of a contact at `point` with unit outward `normal`, both in the part's frame P: D is the
/// greatest depth behind the plane, each point's depth tapered from 1 to nothing between R_ref/2 and R_ref
/// from the axis; p* is the mean of the points within 0.2 mm of D, weight area x (1 - (D - d)/0.2 mm)
/// (model.md, section 4). Below 0.2 mm of depth the band is D itself, so that points come in with weight
/// nothing.
[[nodiscard]] Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                                 double reference_radius) noexcept;

/// [rt] The same, to the bit, by way of the points of `kept` where these surely hold all that count; else it
/// is made anew.
[[nodiscard]] Support support_of(const PartPoints& part, const Vec3& point, const Vec3& normal,
                                 double reference_radius, Shortlist& kept) noexcept;

}  // namespace palpate::contact
