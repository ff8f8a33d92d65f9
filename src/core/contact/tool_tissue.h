#pragma once
#include <array>
#include <span>

#include "core/contact/inclusions.h"
#include "core/contact/organ_surface.h"
#include "core/contact/stiffness_map.h"
#include "core/contact/tissue_laws.h"
#include "palpate/inclusion.h"

namespace palpate::contact {

/// The tissue as one tool meets it in this tick.
struct ToolTissue {
  const TissueLaws& laws;
  std::span<const InclusionNow> inclusions;  // at most model::kMaxInclusions
  const StiffnessMap& map;
  double tip_radius;                                  // of the tool [m]
  double size_factor = laws.size_factor(tip_radius);  // a power: a tick passes the one that its tool keeps

  [[nodiscard]] bool uniform() const noexcept { return inclusions.empty() && map.empty(); }
};

/// The tissue at one point c of the rest surface, where it is not uniform (docs/lumps.md). Its energy is
///
///     U(D, c) = U_0(D) k(c) cap(prod_j (1 + e_j(D, s_j^2))),   s_j^2 = |c - centre_j|^2 - h_j^2,
///
/// with k the stiffness map, times the tool's size factor, and e_j the inclusions' laws. (A product stays
/// positive where several soft inclusions overlap; model::cap_factor() bounds it where hard ones do.)
class TissueAt final {
 public:
  /// [rt] @param tissue must outlive this
  TissueAt(const ToolTissue& tissue, const SurfacePoint& place) noexcept;

  struct Force {
    double normal = 0.0;             // dU/dD [N]
    Vec3 lateral_S = Vec3::Zero();   // -dU/dc [N]; the component along the normal has no meaning
    double slope = 0.0;              // about d(normal)/dD [N/m]
    model::ContactResponse uniform;  // of the law alone
  };
  /// [rt] The elastic force at a depth D [m] >= 0. @param law of this tissue, press or pull
  [[nodiscard]] Force force_at(const model::SpringLaw& law, double depth) const noexcept;

  /// [rt] One step of Newton's method towards the depth at which the normal force is `normal` [N]: the depth
  /// follows a slowly changing force from tick to tick.
  /// @param depth the depth so far [m], changed @return the lateral force at the depth so far [N]
  [[nodiscard]] Vec3 follow(const model::SpringLaw& law, double normal, double& depth) const noexcept;

 private:
  std::span<const InclusionNow> inclusions_;
  double tip_radius_;
  StiffnessMap::Factor factor_;
  Vec3 place_S_;
  std::array<double, model::kMaxInclusions> squares_;  // s_j^2 [m^2]; one an inclusion
};

}  // namespace palpate::contact
