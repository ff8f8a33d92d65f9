#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// [setup] The shortest decimal form of a double that reads back to the same bits ("inf", "nan" for those).
[[nodiscard]] std::string shortest(double value);

/// [setup] The known word nearest to `word` by edit distance, or empty when none is near (for "did you
/// mean").
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace palpate
