#pragma once
#include <nlohmann/json.hpp>

namespace palpate::identify {

/// [setup] A number as results files have it. JSON has none that is not finite: those stand as words.
[[nodiscard]] nlohmann::ordered_json number_json(double value);

/// [setup] The number that number_json() wrote. @throws InputError when it is none
[[nodiscard]] double number_of(const nlohmann::ordered_json& json);

}  // namespace palpate::identify
