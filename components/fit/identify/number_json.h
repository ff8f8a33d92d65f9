#pragma once
#include <nlohmann/json.hpp>

namespace palpate::identify {

/// [setup] A number for a results file. JSON has no infinite or NaN numbers; these are written as strings.
[[nodiscard]] nlohmann::ordered_json number_json(double value);

/// [setup] Reads a number written by number_json(). @throws InputError when it is not a number
[[nodiscard]] double number_of(const nlohmann::ordered_json& json);

}  // namespace palpate::identify
