#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace palpate {

/// Largest nesting depth of a JSON or TOML text from a file or a client. The files of Palpate have at most 8
/// levels.
inline constexpr int kMaxNesting = 64;

// The libraries for JSON and TOML copy, write and destroy a tree of values by recursion, so a deep tree would
// overflow the stack. These functions look at the text before a library reads it. Of a text that is not valid
// they may give any result: the library refuses it where it becomes invalid.

/// [any] Index of the first bracket of a JSON text that is nested deeper than `levels`.
[[nodiscard]] std::optional<std::size_t> json_nested_deeper_at(std::string_view text, int levels) noexcept;

/// [any] Index of the first bracket or dot of a TOML text that makes a value nested deeper than `levels`. The
/// parts of dotted keys and of table headers count like brackets: a.b.c = 1 has three levels. Arrays of
/// tables count once, although a reader has two levels of values for each.
[[nodiscard]] std::optional<std::size_t> toml_nested_deeper_at(std::string_view text, int levels);

}  // namespace palpate
