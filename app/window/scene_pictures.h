#pragma once
#include <span>
#include <string_view>

namespace palpate::app {

/// [any] The picture of a built-in scene as a PNG file, 240 x 160 pixels; empty: there is none of this name.
[[nodiscard]] std::span<const unsigned char> scene_picture(std::string_view name) noexcept;

}  // namespace palpate::app
