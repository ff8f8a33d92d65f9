#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// [setup] The shortest decimal text of a double that reads back to the same bits, or "inf", "nan".
[[nodiscard]] std::string shortest(double value);

/// [setup] A number with `digits` significant digits: brief(0.123456) is "0.1235".
[[nodiscard]] std::string brief(double value, int digits = 4);

/// [any] Number of decimals that a step between labels needs, at most 6: 1 for 2.5, 0 for 20.
[[nodiscard]] int decimals_of_step(double step) noexcept;

/// [setup] A fraction in per cent with `decimals` decimals: percent(0.123456) is "12.35 %".
[[nodiscard]] std::string percent(double share, int decimals = 2);

/// [setup] A text from outside, made safe for a one-line message: control characters become blanks.
[[nodiscard]] std::string one_line(std::string text);

/// [setup] A number with its noun: "1 row", "2 rows".
[[nodiscard]] std::string counted(std::uint64_t number, std::string_view one, std::string_view more);

/// [setup] The text with ASCII letters made small.
[[nodiscard]] std::string lower_case(std::string_view text);

/// [setup] The strings joined with `between`.
[[nodiscard]] std::string joined(std::span<const std::string> words, std::string_view between = ", ");

/// [any] The text without blanks, tabs and line ends at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

/// [setup] A text from outside, made safe for a message: one line, cut after `most` characters with "...".
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t most = 60);

/// [any] The number that is the whole text, as std::from_chars reads it ("inf" and "nan" included, a sign +
/// allowed); nullopt otherwise or beyond the range of a double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text) noexcept;

/// [setup] The string of `known` nearest to `word` by edit distance, for "did you mean"; empty when none is
/// near.
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// [setup] ", with values in N, not mN" for force_mN beside force_N: a name of which only the unit is another
/// one would be renamed with its values left as they are. Empty where the names differ otherwise.
[[nodiscard]] std::string other_unit(std::string_view name, std::string_view meant);

}  // namespace palpate
