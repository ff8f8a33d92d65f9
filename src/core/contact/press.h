#pragma once
#include "core/contact/state.h"
#include "core/contact/tool_tissue.h"

namespace palpate::contact {

/// [rt] Updates the press contacts of one part that has been moved (distance_cache.h): moves the proxies,
/// ends and merges contacts, starts new ones, then computes depth, force and friction of each (docs/model.md,
/// section 4).
/// @return status bits
std::uint32_t update_press(const World::Data& world, const ToolTissue& tissue, const PartPoints& points,
                           PartState& part) noexcept;

}  // namespace palpate::contact
