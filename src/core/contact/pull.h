#pragma once
#include "core/contact/state.h"

namespace palpate::contact {

/// [rt] The jaws' hold at one tick: closing on tissue, the stretch and its force, letting go (model.md,
/// section 4, "Pull"). The parts have been moved. Sets the press level of the parts that hold.
/// @return status bits
std::uint32_t update_pull(const World::Data& world, const TissueLaws& laws, const ToolPoints& points,
                          double gripper, ToolState& tool) noexcept;

/// [rt] Whether the hold gives a force, now or fading.
[[nodiscard]] inline bool pulls(const GripState& grip) noexcept { return grip.held || grip.fade > 0.0; }

}  // namespace palpate::contact
