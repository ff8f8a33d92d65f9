#pragma once
#include "palpate/offscreen.h"

namespace palpate::render {

/// [setup] Colour [0 to 1] of the displacement map for a fraction of its range, 0 to 1: dark blue over green
/// to yellow. Linear light, before shading, as in the shader.
[[nodiscard]] Vec3 map_colour(double share) noexcept;

/// [any] Converts linear light to sRGB, both 0 to 1.
[[nodiscard]] double srgb(double linear) noexcept;

/// [setup] Draws the legend of the displacement map into the upper right corner: a colour bar with five marks
/// in millimetres from 0 to the range, on a dark background. Glyphs are grids of 5 x 7 squares, scaled with
/// the picture. Pictures under 120 x 160 pixels are left unchanged.
/// @param range displacement at the upper end of the bar [m]; <= 0: no legend
void draw_map_legend(Image& image, double range);

}  // namespace palpate::render
