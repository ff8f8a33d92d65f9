#include "view/render/map_legend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace palpate::render {
namespace {

constexpr int kGlyphWidth = 5;
constexpr int kGlyphHeight = 7;
constexpr int kMarks = 5;

struct Glyph {
  char letter;
  std::array<const char*, kGlyphHeight> rows;
};

constexpr Glyph kGlyphs[] = {
    {'0', {" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "}},
    {'1', {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
    {'2', {" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"}},
    {'3', {" ### ", "#   #", "    #", "  ## ", "    #", "#   #", " ### "}},
    {'4', {"   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "}},
    {'5', {"#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "}},
    {'6', {"  ## ", " #   ", "#    ", "#### ", "#   #", "#   #", " ### "}},
    {'7', {"#####", "    #", "   # ", "  #  ", "  #  ", "  #  ", "  #  "}},
    {'8', {" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "}},
    {'9', {" ### ", "#   #", "#   #", " ####", "    #", "   # ", " ##  "}},
    {'.', {"     ", "     ", "     ", "     ", "     ", " ##  ", " ##  "}},
    {'e', {"     ", "     ", " ### ", "#   #", "#####", "#    ", " ### "}},
    {'-', {"     ", "     ", "     ", "#####", "     ", "     ", "     "}},
    {'+', {"     ", "  #  ", "  #  ", "#####", "  #  ", "  #  ", "     "}},
    {'m', {"     ", "     ", "## # ", "# # #", "# # #", "# # #", "# # #"}},
};

struct Rgb {
  std::uint8_t red, green, blue;
};

constexpr Rgb kLetters = {235, 238, 242};

/// Fills a rectangle, clipped to the picture.
void fill(Image& image, int x, int y, int width, int height, Rgb colour) {
  for (int row = std::max(y, 0); row < std::min(y + height, image.height); ++row) {
    for (int column = std::max(x, 0); column < std::min(x + width, image.width); ++column) {
      const std::size_t at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(column));
      image.rgb[at] = colour.red;
      image.rgb[at + 1] = colour.green;
      image.rgb[at + 2] = colour.blue;
    }
  }
}

/// Draws text with its upper left corner at (x, y), in squares of `square` pixels.
void write(Image& image, int x, int y, int square, const char* text) {
  for (; *text != '\0'; ++text, x += (kGlyphWidth + 1) * square) {
    const auto* glyph = std::find_if(std::begin(kGlyphs), std::end(kGlyphs),
                                     [text](const Glyph& g) { return g.letter == *text; });
    if (glyph == std::end(kGlyphs)) continue;
    for (int row = 0; row < kGlyphHeight; ++row) {
      for (int column = 0; column < kGlyphWidth; ++column) {
        if (glyph->rows[static_cast<std::size_t>(row)][column] != '#') continue;
        fill(image, x + column * square, y + row * square, square, square, kLetters);
      }
    }
  }
}

double smooth_step(double low, double high, double t) {
  const double x = std::clamp((t - low) / (high - low), 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

std::uint8_t encode(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(srgb(linear), 0.0, 1.0)));
}

}  // namespace

Vec3 map_colour(double share) noexcept {
  const double t = std::clamp(share, 0.0, 1.0);
  Vec3 colour(0.063, 0.0006, 0.089);
  colour += smooth_step(0.0, 0.35, t) * (Vec3(0.026, 0.162, 0.262) - colour);
  colour += smooth_step(0.3, 0.65, t) * (Vec3(0.036, 0.370, 0.217) - colour);
  colour += smooth_step(0.6, 1.0, t) * (Vec3(0.980, 0.800, 0.019) - colour);
  return colour;
}

double srgb(double linear) noexcept {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

void draw_map_legend(Image& image, double range) {
  if (!(range > 0.0) || image.width < 120 || image.height < 160) return;
  const int square = std::max(1, std::min(image.width, image.height) / 300);
  const int line = (kGlyphHeight + 2) * square;
  const int bar_width = 8 * square;
  const int bar_height = image.height * 2 / 5;
  const int width = bar_width + (5 * (kGlyphWidth + 1) + 8) * square;
  const int x = image.width - width - 4 * square;
  const int y = 3 * line;
  fill(image, x - 4 * square, y - 2 * line, width + 4 * square, bar_height + 3 * line + line / 2,
       {34, 37, 42});
  write(image, x, y - line - line / 2, square, "mm");
  for (int row = 0; row < bar_height; ++row) {
    const Vec3 colour = map_colour(1.0 - row / (bar_height - 1.0));
    fill(image, x, y + row, bar_width, 1, {encode(colour.x()), encode(colour.y()), encode(colour.z())});
  }
  for (int mark = 0; mark < kMarks; ++mark) {
    const double share = mark / (kMarks - 1.0);
    const int at = y + static_cast<int>(std::lround((1.0 - share) * (bar_height - 1)));
    char text[16];
    std::snprintf(text, sizeof text, "%.3g", 1e3 * share * range);
    fill(image, x + bar_width, at - square / 2, 3 * square, std::max(1, square), kLetters);
    write(image, x + bar_width + 5 * square, at - kGlyphHeight * square / 2, square, text);
  }
}

}  // namespace palpate::render
