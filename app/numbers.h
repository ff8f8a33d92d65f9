#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::app {

/// [setup] The number that `text` is, all of it: no spaces, no sign +, no hexadecimal. @param flag as the
/// user typed it, e.g. "--rate-Hz". @throws InputError naming flag and text when it is none or not finite.
[[nodiscard]] double parse_number(const std::string& flag, const std::string& text);

/// [setup] As parse_number(), >= 0. @throws InputError also below.
[[nodiscard]] double parse_not_negative(const std::string& flag, const std::string& text);

/// [setup] As parse_number(), > 0. @throws InputError also at 0 and below.
[[nodiscard]] double parse_positive(const std::string& flag, const std::string& text);

/// [setup] Numbers >= 0 between commas, at least one. @throws InputError naming flag and the bad entry.
[[nodiscard]] std::vector<double> parse_not_negative_list(const std::string& flag, const std::string& text);

/// [setup] A whole number 0 .. 2^64-1. @throws InputError naming flag and text.
[[nodiscard]] std::uint64_t parse_whole(const std::string& flag, const std::string& text);

}  // namespace palpate::app
