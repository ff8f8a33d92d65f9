#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "run/palpation/score.h"

namespace palpate::palpation {

/// A measure of a score, as all outputs show it.
struct ScoreField {
  const char* key;  // in the JSON document
  nlohmann::ordered_json value;
  const char* name = nullptr;  // in text, report and window; nullptr: in the JSON document alone
  std::string text{};          // its value there
  std::string definition{};
};

/// [setup] The fields that have a name.
[[nodiscard]] std::vector<Measure> measures_of(const std::vector<ScoreField>& fields);
/// [setup] An object with all fields.
[[nodiscard]] nlohmann::ordered_json json_of(const std::vector<ScoreField>& fields);

}  // namespace palpate::palpation
