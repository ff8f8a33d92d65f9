#include "fit/identify/number_json.h"

#include <cmath>
#include <limits>
#include <string>

#include "palpate/error.h"

namespace palpate::identify {

nlohmann::ordered_json number_json(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0.0 ? "inf" : "-inf";
}

double number_of(const nlohmann::ordered_json& json) {
  if (json.is_number()) return json.get<double>();
  const std::string word = json.is_string() ? json.get<std::string>() : json.dump();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (word == "inf") return std::numeric_limits<double>::infinity();
  if (word == "-inf") return -std::numeric_limits<double>::infinity();
  throw InputError("\"" + word + "\" is no number");
}

}  // namespace palpate::identify
