#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::fit {

/// What editors put before the first line of a text that is UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// [any] Without spaces, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// [setup] The cells between a line's commas, trimmed. @param cells is overwritten
void split(std::string_view line, std::vector<std::string_view>& cells);

/// [setup] Text of a file fit for a message and for a name: short, printable.
[[nodiscard]] std::string shown(std::string_view cell);

/// [any] Whether the whole cell is a number, as from_chars reads it, a sign + allowed. @param value gets it
[[nodiscard]] bool parse_number(std::string_view cell, double& value);

}  // namespace palpate::fit
