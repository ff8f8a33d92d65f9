#pragma once
#include "core/contact/state.h"

namespace palpate::contact {

/// [rt] The press contacts of one part at one tick: those that are there walk and turn, some end or merge,
/// new ones start; then depth, force and friction of each (model.md, section 4). The part has been moved
/// (distance_cache.h).
/// @return status bits
std::uint32_t update_press(const World::Data& world, const TissueLaws& laws, const PartPoints& points,
                           PartState& part) noexcept;

}  // namespace palpate::contact
