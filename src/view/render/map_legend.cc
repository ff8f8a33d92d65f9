#include "view/render/map_legend.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "core/base/text.h"

namespace palpate::render {
namespace {

constexpr int kMarks = 5;
constexpr int kBarWidth = 8;                                          // squares of a glyph
constexpr int kLegendWidth = kBarWidth + 5 * (kGlyphWidth + 1) + 16;  // squares, with a margin

double smooth_step(double low, double high, double t) {
  const double x = std::clamp((t - low) / (high - low), 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

std::uint8_t encode(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(srgb(linear), 0.0, 1.0)));
}

// What a legend says: the numbers at the ends of its bar are scale * low and scale * high.
struct LegendText {
  double low;
  double high;
  const char* unit;
  double scale = 1.0;
};

bool can_hold_legend(const Image& image) { return image.width >= 120 && image.height >= 160; }

// Draws a legend into the upper right corner, in squares of `square` pixels.
void draw_bar(Image& image, int square, const LegendText& legend) {
  const int line = (kGlyphHeight + 2) * square;
  const int bar_width = kBarWidth * square;
  const int bar_height = image.height * 2 / 5;
  const int x = image.width - (kLegendWidth - 4) * square;
  const int y = 3 * line;
  fill(image, x - 4 * square, y - 2 * line, (kLegendWidth - 4) * square, bar_height + 3 * line + line / 2,
       kTextBackground);
  write(image, x, y - line - line / 2, square, legend.unit);
  for (int row = 0; row < bar_height; ++row) {
    const Vec3 colour = map_colour(1.0 - row / (bar_height - 1.0));
    fill(image, x, y + row, bar_width, 1, {encode(colour.x()), encode(colour.y()), encode(colour.z())});
  }
  for (int mark = 0; mark < kMarks; ++mark) {
    const double share = mark / (kMarks - 1.0);
    const int at = y + static_cast<int>(std::lround((1.0 - share) * (bar_height - 1)));
    const double range = legend.high - legend.low;
    const double value = legend.low + share * range;
    // Neither "-0" nor the rounding error of a zero between the ends.
    const std::string text = brief(std::abs(value) < 1e-9 * range ? 0.0 : legend.scale * value, 3);
    fill(image, x + bar_width, at - square / 2, 3 * square, std::max(1, square), kTextColour);
    write(image, x + bar_width + 5 * square, at - kGlyphHeight * square / 2, square, text.c_str());
  }
}

struct Glyph {
  char letter;
  std::uint64_t squares;  // 7 rows of 5 bits; the highest of the 35 is the upper left square
};

constexpr Glyph kGlyphs[] = {
    {'0', 0x3A33AE62E}, {'1', 0x11842108E}, {'2', 0x3A211111F}, {'3', 0x3A213062E}, {'4', 0x08CA97C42},
    {'5', 0x7E1E0862E}, {'6', 0x1910F462E}, {'7', 0x7C2221084}, {'8', 0x3A317462E}, {'9', 0x3A317844C},
    {'A', 0x3A31FC631}, {'B', 0x7A31F463E}, {'C', 0x3A308422E}, {'D', 0x7A318C63E}, {'E', 0x7E10F421F},
    {'F', 0x7E10F4210}, {'G', 0x3A30BC62F}, {'H', 0x4631FC631}, {'I', 0x38842108E}, {'J', 0x1C4210A4C},
    {'K', 0x4654C5251}, {'L', 0x42108421F}, {'M', 0x4775AC631}, {'N', 0x4739ACE71}, {'O', 0x3A318C62E},
    {'P', 0x7A31F4210}, {'Q', 0x3A318D64D}, {'R', 0x7A31F5251}, {'S', 0x3E107043E}, {'T', 0x7C8421084},
    {'U', 0x46318C62E}, {'V', 0x46318C544}, {'W', 0x4631AD6AA}, {'X', 0x462A22A31}, {'Y', 0x462A21084},
    {'Z', 0x7C222221F}, {'a', 0x000E0BE2F}, {'b', 0x421E8C63E}, {'c', 0x000E8422E}, {'d', 0x042F8C62F},
    {'e', 0x000E8FE0E}, {'f', 0x1928E2108}, {'g', 0x01F18BC2E}, {'h', 0x4216CC631}, {'i', 0x100C2108E},
    {'j', 0x080610A4C}, {'k', 0x210953149}, {'l', 0x30842108E}, {'m', 0x001AAD6B5}, {'n', 0x0016CC631},
    {'o', 0x000E8C62E}, {'p', 0x001E8FA10}, {'q', 0x000D9BC21}, {'r', 0x0016CC210}, {'s', 0x000F8383E},
    {'t', 0x211C42126}, {'u', 0x00118C66D}, {'v', 0x00118C544}, {'w', 0x00118D6AA}, {'x', 0x001151151},
    {'y', 0x00118BC2E}, {'z', 0x001F1111F}, {'+', 0x0084F9080}, {',', 0x000003088}, {'-', 0x0000F8000},
    {'.', 0x00000018C}};

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
  if (!(range > 0.0) || !can_hold_legend(image)) return;
  draw_bar(image, glyph_square(image.width, image.height), {0.0, range, "mm", 1e3});
}

Image legend_panel(int height, double low, double high, const char* unit) {
  const int square = std::max(1, height / 220);
  Image panel{kLegendWidth * square, height, {}};
  panel.rgb.resize(3 * static_cast<std::size_t>(panel.width) * static_cast<std::size_t>(height));
  fill(panel, 0, 0, panel.width, height, kTextBackground);
  draw_bar(panel, square, {low, high, unit});
  return panel;
}

void draw_title(Image& image, const std::string& title) {
  const int length = static_cast<int>(title.size()) * (kGlyphWidth + 1) + 3;  // squares, with a margin
  int square = glyph_square(image.width, image.height);
  if (2 * square * length <= image.width) square *= 2;
  fill(image, 0, 0, square * length, square * (kGlyphHeight + 4), kTextBackground);
  write(image, 2 * square, 2 * square, square, title.c_str());
}

Image side_by_side(const Image& left, const Image& right) {
  Image both{left.width + right.width, std::max(left.height, right.height), {}};
  both.rgb.resize(3 * static_cast<std::size_t>(both.width) * static_cast<std::size_t>(both.height));
  fill(both, 0, 0, both.width, both.height, kTextBackground);
  const auto copy = [&both](const Image& part, int x) {
    for (int row = 0; row < part.height; ++row) {
      const std::ptrdiff_t length = 3 * part.width;
      std::copy_n(part.rgb.begin() + row * length, length,
                  both.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(row) * both.width + x));
    }
  };
  copy(left, 0);
  copy(right, left.width);
  return both;
}

int glyph_square(int width, int height) noexcept { return std::max(1, std::min(width, height) / 300); }

void fill(Image& image, int x, int y, int width, int height, Rgb colour) noexcept {
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

void write(Image& image, int x, int y, int square, const char* text) noexcept {
  for (; *text != '\0'; ++text, x += (kGlyphWidth + 1) * square) {
    const auto* glyph = std::find_if(std::begin(kGlyphs), std::end(kGlyphs),
                                     [text](const Glyph& g) { return g.letter == *text; });
    if (glyph == std::end(kGlyphs)) continue;
    for (int row = 0; row < kGlyphHeight; ++row) {
      for (int column = 0; column < kGlyphWidth; ++column) {
        const int bit = (kGlyphHeight - row) * kGlyphWidth - 1 - column;
        if (((glyph->squares >> bit) & 1U) == 0) continue;
        fill(image, x + column * square, y + row * square, square, square, kTextColour);
      }
    }
  }
}

}  // namespace palpate::render
