#pragma once
#include <cstdint>
#include <optional>
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

/// [setup] A number and what it counts: "1 row", "2 rows".
[[nodiscard]] std::string counted(std::uint64_t number, std::string_view one, std::string_view more);

/// [setup] The words with `between` after each but the last.
[[nodiscard]] std::string joined(std::span<const std::string> words, std::string_view between = ", ");

/// [any] Without blanks, tabs and line ends at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

/// [setup] A foreign text fit for a message: one line, "..." for what is beyond `most` characters.
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t most = 60);

/// [any] The number that is the whole text, as std::from_chars reads it (with "inf" and "nan"), a sign +
/// allowed; none when it is beyond a double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text) noexcept;

/// [setup] The known word nearest to `word` by edit distance, or empty when none is near (for "did you
/// mean").
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace palpate
