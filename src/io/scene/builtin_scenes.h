#pragma once
#include <span>
#include <string_view>

#include "palpate/scene.h"

namespace palpate::scene {

/// A scene that comes with the program. Its file is in the folder examples/; the program contains the text
/// too.
struct BuiltinScene {
  std::string_view name;   // of the file, without its extension
  std::string_view title;  // a few words, for a list or a picture's caption
  std::string_view line;   // what the user does in it, one sentence of at most 90 characters
  std::string_view file;   // relative to the repository or the installed share/palpate: "examples/NAME.toml"
  std::string_view toml;   // the file's text
};

/// [any] All built-in scenes, in the order of lists and galleries.
[[nodiscard]] std::span<const BuiltinScene> builtin_scenes() noexcept;

/// [setup] A request for the scene in which each hand holds a device of this kind, such as "mouse". It needs
/// no file.
[[nodiscard]] Overrides request_of(const BuiltinScene& builtin, const std::string& device_kind);

}  // namespace palpate::scene
