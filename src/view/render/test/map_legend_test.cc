#include "view/render/map_legend.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::render {
namespace {

Image grey(int width, int height) {
  return {
      width, height,
      std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 128)};
}

std::size_t pixel_at(const Image& image, int x, int y) {
  return 3 *
         (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
}

/// Column of the colour bar: the first from the right whose colour in this row is neither background nor
/// grey.
int bar_column(const Image& image, int y) {
  for (int x = image.width - 1; x >= 0; --x) {
    const std::uint8_t* pixel = &image.rgb[pixel_at(image, x, y)];
    if (pixel[0] > pixel[2] + 60) return x;
  }
  return -1;
}

TEST(MapLegend, ColoursRunFromDarkBlueOverGreenToYellow) {
  EXPECT_GT(map_colour(0.0).z(), map_colour(0.0).y());
  EXPECT_GT(map_colour(0.65).y(), map_colour(0.65).x());
  EXPECT_GT(map_colour(0.65).y(), map_colour(0.65).z());
  EXPECT_GT(map_colour(1.0).x(), 0.9);
  EXPECT_LT(map_colour(1.0).z(), 0.05);
  EXPECT_EQ(map_colour(2.0), map_colour(1.0));
  EXPECT_EQ(map_colour(-1.0), map_colour(0.0));
}

TEST(MapLegend, ItsBarIsYellowAboveAndDarkBelowAndLeavesTheLeftAlone) {
  Image image = grey(800, 600);
  draw_map_legend(image, 0.012);
  const int top = 3 * 9 * 2 + 1;  // three lines of 9 squares of 2 pixels each
  const int x = bar_column(image, top);
  ASSERT_GT(x, 600);
  const std::uint8_t* bottom = &image.rgb[pixel_at(image, x, top + 600 * 2 / 5 - 3)];
  EXPECT_LT(bottom[1], 40);
  for (int y = 0; y < 600; ++y) EXPECT_EQ(image.rgb[pixel_at(image, 600, y)], 128);
}

TEST(MapLegend, OtherRangesHaveOtherNumbers) {
  Image small = grey(800, 600);
  Image large = grey(800, 600);
  draw_map_legend(small, 0.002);
  draw_map_legend(large, 0.012);
  EXPECT_NE(small.rgb, large.rgb);
}

TEST(MapLegend, NoRangeOrATinyPictureStaysAsItIs) {
  Image image = grey(800, 600);
  draw_map_legend(image, 0.0);
  EXPECT_EQ(image.rgb, grey(800, 600).rgb);
  Image tiny = grey(100, 100);
  draw_map_legend(tiny, 0.01);
  EXPECT_EQ(tiny.rgb, grey(100, 100).rgb);
}

TEST(MapLegend, ItsNumbersStartAtTheLowerValueAndItsUnitIsShown) {
  EXPECT_NE(legend_panel(660, 1.0, 4.0, "x").rgb, legend_panel(660, 0.0, 4.0, "x").rgb);
  EXPECT_NE(legend_panel(660, 0.0, 4.0, "mm").rgb, legend_panel(660, 0.0, 4.0, "x").rgb);
}

TEST(MapLegend, APanelIsAsHighAsAskedAndHoldsTheWholeBar) {
  const Image panel = legend_panel(660, 1.0, 4.0, "x");
  EXPECT_EQ(panel.height, 660);
  EXPECT_LT(panel.width, 200);
  EXPECT_EQ(panel.rgb.size(), 3 * static_cast<std::size_t>(panel.width) * 660);
  EXPECT_GT(bar_column(panel, 3 * 9 * 3 + 1), 0);  // three lines of 9 squares of 3 pixels each
}

TEST(PixelFont, EveryLetterAndDigitHasAGlyphOfItsOwn) {
  std::set<std::vector<std::uint8_t>> drawn;
  const std::string all = " ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,-+";
  for (const char letter : all) {
    Image image = grey(kGlyphWidth, kGlyphHeight);
    write(image, 0, 0, 1, std::string(1, letter).c_str());
    drawn.insert(image.rgb);
  }
  EXPECT_EQ(drawn.size(), all.size());
}

TEST(Title, IsWrittenIntoTheUpperLeftCornerOnly) {
  Image image = grey(800, 600);
  draw_title(image, "Felt");
  int bright = 0;
  for (int y = 0; y < 600; ++y) {
    for (int x = 0; x < 800; ++x) {
      const std::uint8_t red = image.rgb[pixel_at(image, x, y)];
      if (x >= 110 || y >= 50) {
        EXPECT_EQ(red, 128);
      }
      if (red > 200) ++bright;
    }
  }
  EXPECT_GT(bright, 200);
}

TEST(SideBySide, HoldsBothPicturesUnchangedAndFillsUpTheLowerOne) {
  Image left = grey(4, 3);
  Image right = grey(2, 5);
  right.rgb[pixel_at(right, 1, 4)] = 7;
  const Image both = side_by_side(left, right);
  ASSERT_EQ(both.width, 6);
  ASSERT_EQ(both.height, 5);
  EXPECT_EQ(both.rgb[pixel_at(both, 3, 2)], 128);
  EXPECT_EQ(both.rgb[pixel_at(both, 4, 0)], 128);
  EXPECT_EQ(both.rgb[pixel_at(both, 5, 4)], 7);
  EXPECT_EQ(both.rgb[pixel_at(both, 0, 4)], kTextBackground.red);
}

}  // namespace
}  // namespace palpate::render
