#include "view/render/map_legend.h"

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

}  // namespace
}  // namespace palpate::render
