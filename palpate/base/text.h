#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// [setup] The shortest decimal form of a double that reads back to the same bits ("inf", "nan" for those).
[[nodiscard]] std::string shortest(double value);

/// [setup] So many significant digits, for people to read: brief(0.123456) is "0.1235".
[[nodiscard]] std::string brief(double value, int digits = 4);

/// [setup] A share in per cent, with so many decimals: percent(0.123456) is "12.35 %".
[[nodiscard]] std::string percent(double share, int decimals = 2);

/// [setup] A foreign text fit for a message of one line: control characters become blanks.
[[nodiscard]] std::string one_line(std::string text);

/// [setup] The known word nearest to `word` by edit distance, or empty when none is near (for "did you
/// mean").
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace palpate
