#pragma once
#include <string>
#include <vector>

#include "fit/identify/map_fit.h"

namespace palpate::identify {

/// [setup] What a map must be, by the rules for the curve of a specimen: of the loops of a probe the last
/// loading stays. @param tip_radius of the ball [m] @return one sentence for each doubt: rows left out,
/// units, a reading before contact @throws InputError for a radius that no ball has, a probe at several
/// places, forces below zero, or a force that does not rise out of its noise
[[nodiscard]] std::vector<std::string> check_map(std::vector<MapRow>& rows, double tip_radius);

}  // namespace palpate::identify
