#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate::scene {

/// [setup] Whether a user's text is a path: it has a '/' or the extension of a file format (.toml, .stl,
/// .csv, ...). Otherwise it is a built-in name.
[[nodiscard]] bool is_path(std::string_view text);

/// [setup] "a, b or c", for messages.
[[nodiscard]] std::string alternatives(std::span<const std::string> words);

}  // namespace palpate::scene
