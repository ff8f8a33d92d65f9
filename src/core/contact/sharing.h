#pragma once
#include <span>

#include "core/contact/proxy.h"

namespace palpate::contact {

/// [rt] Several contacts on one organ share its tissue: sets the share of each, so that coincident contacts
/// weigh as one, distant ones add, and nothing jumps as they part (model.md, section 4).
void share_tissue(double reference_radius, std::span<Load* const> contacts) noexcept;

/// [rt] Two contacts that become one both remember the mean of what they did, for the force that each has
/// now: the force of the two together stays as it is, and what stays has relaxed.
void share_memory(Load& a, Load& b) noexcept;

}  // namespace palpate::contact
