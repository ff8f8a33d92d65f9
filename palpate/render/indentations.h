#pragma once
#include <vector>

#include "palpate/deform/displacement.h"
#include "palpate/haptics/loop.h"

namespace palpate::render {

/// [setup] The places where a snapshot's tools press or pull the organ, organ frame.
///
/// A tip is drawn no blunter than it is wide: R is the smaller of its radius of curvature and its half-width
/// there. The bound of R_1 itself (Indentation::half_width) is not used: a ball's half-width is its radius,
/// and R_1 so bounded would cut the drawn surface through a ball that is pressed deeper than its radius; in
/// the finite-element runs that the profile was fitted to, R_1 reaches 1.56 R at D = 2 R.
[[nodiscard]] std::vector<deform::Indentation> indentations_of(const haptics::Snapshot& snapshot);

}  // namespace palpate::render
