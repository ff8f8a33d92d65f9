#pragma once
#include "core/contact/state.h"

namespace palpate::contact {

/// [rt] The press contacts of one part at one tick: those that are there walk and turn, some end or merge,
/// new ones start; then depth, force and friction of each (model.md, section 4). The part has been moved
/// (distance_cache.h).
/// @return status bits
std::uint32_t update_press(const World::Data& world, const TissueLaws& laws, const PartPoints& points,
                           PartState& part) noexcept;

/// [rt] Friction of one contact [N] and its slip s [m], after the tool has moved where it touches: a spring
/// k_t [N/m] and a damper c_t [N s/m] in parallel, in series with a Coulomb slider,
///   f = k_t s + c_t (s - s_before)/T, |f| <= mu F_n.
/// Spring and cone: [Hayward, Armstrong 2000]; the damper on ds/dt is sigma_1 of [Canudas de Wit et al.
/// 1995]. Where the contact slides, f lies on the cone and s is solved from it, so that c_t damps the spring
/// and not the slider. f is that of the tick's end, so it takes from the hand at least what the spring gains
/// in energy.
/// @param motion of the tool at the contact in this tick [m]
void compute_friction(double period, const TissueLaws& laws, const Vec3& motion, Contact& contact) noexcept;

}  // namespace palpate::contact
