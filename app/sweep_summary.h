#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "science/identify/sweep.h"

namespace palpate::app {

/// [setup] Sweeps as a list (docs/fitting.md has its fields).
[[nodiscard]] nlohmann::ordered_json sweeps_json(const std::vector<identify::Sweep>& sweeps);

/// [setup] The same as CSV, a line a value; what there is none of is empty.
[[nodiscard]] std::string sweeps_csv(const std::vector<identify::Sweep>& sweeps);

/// [setup] What each sweep came to, a line each; nothing for none.
[[nodiscard]] std::string sweeps_text(const std::vector<identify::Sweep>& sweeps);

}  // namespace palpate::app
