#pragma once
#include <span>
#include <vector>

#include "palpate/contact/contact.h"
#include "palpate/deform/displacement.h"

namespace palpate::deform {

/// [setup] Where the tools of all hands press or pull the organ at one tick, organ frame.
///
/// A tip is drawn no blunter than it is wide: R is the smaller of its radius of curvature and its half-width
/// there. The bound of R_1 itself (Indentation::half_width) is not used: a ball's half-width is its radius,
/// and R_1 so bounded would cut the drawn surface through a ball that is pressed deeper than its radius; in
/// the finite-element runs that the profile was fitted to, R_1 reaches 1.56 R at D = 2 R.
/// @param results one a hand (haptics::Snapshot::hand_results)
[[nodiscard]] std::vector<Indentation> indentations_of(std::span<const contact::ToolResult> results);

}  // namespace palpate::deform
