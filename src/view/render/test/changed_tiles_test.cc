#include "view/render/changed_tiles.h"

#include <vector>

#include <gtest/gtest.h>

namespace palpate::render {
namespace {

static_assert(ChangedTiles::kTile == 32);

TEST(ChangedTiles, HoldTheTilesOfABoxAndOneMorePixel) {
  ChangedTiles tiles(320, 320);
  EXPECT_TRUE(tiles.empty());
  tiles.add({40.0F, 65.5F, 50.0F, 80.0F});
  EXPECT_EQ(tiles.bounds(), (PixelBox{32, 64, 64, 96}));
  tiles.add({40.0F, 64.5F, 50.0F, 80.0F});
  EXPECT_EQ(tiles.bounds(), (PixelBox{32, 32, 64, 96}));
}

TEST(ChangedTiles, EndAtTheEdgeOfThePicture) {
  ChangedTiles tiles(100, 70);
  tiles.add({90.0F, 60.0F, 400.0F, 400.0F});
  EXPECT_EQ(tiles.rectangles(), (std::vector<PixelBox>{{64, 32, 100, 70}}));
  tiles.add({-50.0F, -50.0F, -40.0F, -40.0F});
  EXPECT_EQ(tiles.bounds(), (PixelBox{64, 32, 100, 70})) << "nothing in the picture";
}

TEST(ChangedTiles, AreTouchedByWhatIsDrawnInThemAndNotBetweenThem) {
  ChangedTiles tiles(320, 320);
  tiles.add({4.0F, 4.0F, 5.0F, 5.0F});
  tiles.add({300.0F, 300.0F, 301.0F, 301.0F});
  EXPECT_TRUE(tiles.touch({30.0F, 30.0F, 60.0F, 60.0F}));
  EXPECT_FALSE(tiles.touch({100.0F, 100.0F, 200.0F, 200.0F}));
  EXPECT_FALSE(tiles.touch({}));
}

TEST(ChangedTiles, BecomeRectanglesThatCoverEachTileOnce) {
  // Tiles of three rows, from below: XX.  XX.  X.X
  ChangedTiles tiles(96, 96);
  tiles.add({2.0F, 2.0F, 60.0F, 60.0F});
  tiles.add({2.0F, 66.0F, 30.0F, 90.0F});
  tiles.add({66.0F, 66.0F, 90.0F, 90.0F});
  EXPECT_EQ(tiles.rectangles(), (std::vector<PixelBox>{{0, 0, 64, 64}, {0, 64, 32, 96}, {64, 64, 96, 96}}));
  EXPECT_FALSE(tiles.all());
}

TEST(ChangedTiles, AreOneRectangleWhenAllAreAdded) {
  ChangedTiles tiles(100, 70);
  tiles.add_all();
  EXPECT_TRUE(tiles.all());
  EXPECT_EQ(tiles.rectangles(), (std::vector<PixelBox>{{0, 0, 100, 70}}));
}

}  // namespace
}  // namespace palpate::render
