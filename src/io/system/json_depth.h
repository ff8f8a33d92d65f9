#pragma once
#include <optional>
#include <string_view>

namespace palpate {

/// [any] Index of the first bracket of a JSON text that is nested deeper than this many levels. Readers
/// refuse such a text before nlohmann's library, which is recursive, reads it and the stack overflows.
[[nodiscard]] std::optional<std::size_t> nested_deeper_at(std::string_view text, int levels) noexcept;

}  // namespace palpate
