#pragma once
#include <cstdint>

#include "palpate/offscreen.h"

namespace palpate::render {

/// Width and height of a glyph, in squares.
inline constexpr int kGlyphWidth = 5;
inline constexpr int kGlyphHeight = 7;

struct Rgb {
  std::uint8_t red, green, blue;
};

inline constexpr Rgb kTextColour = {235, 238, 242};
inline constexpr Rgb kTextBackground = {34, 37, 42};

/// [any] Side of a glyph's square in a picture of this size [pixels].
[[nodiscard]] int glyph_square(int width, int height) noexcept;

/// [any] Fills a rectangle, clipped to the picture.
void fill(Image& image, int x, int y, int width, int height, Rgb colour) noexcept;

/// [any] Draws text with its upper left corner at (x, y), in squares of `square` pixels. Letters, digits and
/// ". , - +" are drawn; any other character leaves a space.
void write(Image& image, int x, int y, int square, const char* text) noexcept;

}  // namespace palpate::render
