#pragma once
#include <cstdint>
#include <string>

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

/// [setup] Colour [0 to 1] of the displacement map for a fraction of its range, 0 to 1: dark blue over green
/// to yellow. Linear light, before shading, as in the shader.
[[nodiscard]] Vec3 map_colour(double share) noexcept;

/// [any] Converts linear light to sRGB, both 0 to 1.
[[nodiscard]] double srgb(double linear) noexcept;

/// [setup] Draws the legend of the displacement map into the upper right corner: a colour bar with five
/// numbers in millimetres from 0 to the range, on a dark background. Pictures under 120 x 160 pixels are left
/// unchanged.
/// @param range displacement at the upper end of the bar [m]; <= 0: no legend
void draw_map_legend(Image& image, double range);

/// [setup] A legend from `low` to `high` as a narrow picture of its own, to be placed beside others.
/// @param unit above the bar
[[nodiscard]] Image legend_panel(int height, double low, double high, const char* unit);

/// [setup] Writes a title into the upper left corner, on a dark background. Letters are twice as large as in
/// a legend, or as large where the picture is too narrow.
void draw_title(Image& image, const std::string& title);

/// [any] Two pictures as one, with their upper edges level. A lower picture is filled up with background.
[[nodiscard]] Image side_by_side(const Image& left, const Image& right);

}  // namespace palpate::render
