#include "io/system/json_text.h"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "palpate/error.h"

namespace palpate {
namespace {

constexpr std::ptrdiff_t kMaxValues = 4'000'000;  // about 0.5 GB
constexpr std::ptrdiff_t kMaxOrderedMembers = 10'000;

[[noreturn]] void fail(std::string_view text, std::size_t byte, const std::string& what) {
  const std::size_t before = std::min(byte, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(before), '\n');
  throw InputError("line " + std::to_string(line) + ", byte " + std::to_string(byte) + " of " +
                   std::to_string(text.size()) + ": " + what);
}

template <typename Json>
Json parse(std::string_view text, int levels) {
  if (const auto deep = json_nested_deeper_at(text, levels)) {
    fail(text, *deep + 1, "is nested deeper than " + std::to_string(levels) + " levels");
  }
  const auto begins_value = [](char c) { return c == ',' || c == '[' || c == '{'; };
  if (std::count_if(text.begin(), text.end(), begins_value) > kMaxValues) {
    throw InputError("has more than " + std::to_string(kMaxValues) + " values");
  }
  try {
    return Json::parse(text);
  } catch (const typename Json::parse_error& error) {
    fail(text, error.byte, "is no JSON");
  } catch (const typename Json::exception&) {
    throw InputError("has a number that no double holds, must be finite");
  }
}

}  // namespace

nlohmann::json parse_json(std::string_view text, int levels) { return parse<nlohmann::json>(text, levels); }

nlohmann::ordered_json parse_ordered_json(std::string_view text) {
  if (std::count(text.begin(), text.end(), ':') > kMaxOrderedMembers) {
    throw InputError("has more than " + std::to_string(kMaxOrderedMembers) + " members");
  }
  return parse<nlohmann::ordered_json>(text, kMaxNesting);
}

}  // namespace palpate
