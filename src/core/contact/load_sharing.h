#pragma once
#include <span>

#include "core/contact/proxy.h"

namespace palpate::contact {

/// [rt] Divides the tissue's force among contacts on one organ: sets each share, so that coincident contacts
/// count as one, distant ones add, and forces do not step when contacts part (docs/model.md, section 4).
void share_load(double reference_radius, std::span<Load* const> contacts) noexcept;

/// [rt] When two contacts merge, both get their mean relaxation, relative to their elastic forces. The sum of
/// their forces does not change.
void merge_histories(Load& a, Load& b) noexcept;

}  // namespace palpate::contact
