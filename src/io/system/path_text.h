#pragma once
#include <filesystem>
#include <string>
#include <string_view>

// All texts of the library are UTF-8, also those with paths. On Windows paths are UTF-16, and their
// conversions from and to std::string use another encoding, so a text becomes a path, and a path a text, by
// these functions only.
namespace palpate {

/// [setup]
[[nodiscard]] inline std::filesystem::path to_path(std::string_view text) {
  return std::u8string(text.begin(), text.end());
}

/// [setup]
[[nodiscard]] inline std::string to_text(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

}  // namespace palpate
