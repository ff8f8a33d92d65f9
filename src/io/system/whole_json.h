#pragma once
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "palpate/error.h"

namespace palpate {

/// [setup] The integer of `key` in a JSON object of nlohmann's library. JSON numbers may be fractional,
/// negative or too large for a type; nlohmann's conversion then wraps around or is undefined. @throws
/// InputError naming the key, its value and the range; for a missing key the exception of Json::at
template <std::integral Whole, class Json>
[[nodiscard]] Whole whole_number(const Json& json, const char* key) {
  const Json& value = json.at(key);
  if (value.is_number_unsigned()) {
    const auto number = value.template get<std::uint64_t>();
    if (std::in_range<Whole>(number)) return static_cast<Whole>(number);
  } else if (value.is_number_integer()) {
    const auto number = value.template get<std::int64_t>();
    if (std::in_range<Whole>(number)) return static_cast<Whole>(number);
  }
  const std::string found = value.is_primitive() ? value.dump() : value.type_name();
  constexpr std::size_t kLongest = 60;  // characters of the value in the message
  throw InputError(std::string(key) + " is " + found.substr(0, kLongest) + ", want a whole number from " +
                   std::to_string(std::numeric_limits<Whole>::min()) + " to " +
                   std::to_string(std::numeric_limits<Whole>::max()));
}

}  // namespace palpate
