#pragma once
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "io/system/nesting.h"

namespace palpate {

/// [setup] Parses a JSON text; the only place where the program does (tools/lint_sources). @param levels that
/// arrays and objects may be nested in each other @throws InputError "line L, byte B of N: ..." for a text
/// that is no JSON or nested deeper, and for one with over 4 million values or a number that no double holds.
/// No message repeats bytes of the text.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, int levels = kMaxNesting);

/// [setup] As parse_json(), with the members of objects in the order of the text. At most 10,000 members,
/// since the library searches them one by one.
[[nodiscard]] nlohmann::ordered_json parse_ordered_json(std::string_view text);

}  // namespace palpate
