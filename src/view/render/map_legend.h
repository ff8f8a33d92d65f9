#pragma once
#include "palpate/offscreen.h"

namespace palpate::render {

/// [setup] The colour [0 to 1] that the displacement map gives to a share of its range, 0 to 1: dark blue
/// over green to yellow, in linear light, as the shader computes it before it lights the surface.
[[nodiscard]] Vec3 map_colour(double share) noexcept;

/// [any] Linear light [0 to 1] as a screen takes it (sRGB), 0 to 1.
[[nodiscard]] double srgb(double linear) noexcept;

/// [setup] Draws the displacement map's legend into the picture's upper right corner: a bar of the map's
/// colours with five marks in millimetres from 0 to the range, on a dark ground. The letters are those of a
/// grid of 5 x 7 squares, scaled with the picture. A picture too small for it, under 120 x 160 pixels, stays
/// as it is.
/// @param range displacement at the bar's upper end [m], > 0; else the picture stays as it is
void draw_map_legend(Image& image, double range);

}  // namespace palpate::render
