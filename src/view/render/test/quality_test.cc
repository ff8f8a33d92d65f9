#include <gtest/gtest.h>

#include "palpate/offscreen.h"

namespace palpate::render {
namespace {

void add(QualityChoice& choice, int pictures, double ms) {
  for (int i = 0; i < pictures; ++i) choice.add(ms);
}

TEST(QualityChoice, StaysWhilePicturesFitTheBudget) {
  QualityChoice choice;
  add(choice, 1000, 30.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
}

TEST(QualityChoice, GoesDownAfterSomeSlowPictures) {
  QualityChoice choice;
  add(choice, 30, 45.0);
  EXPECT_EQ(choice.now(), Quality::kFast);
}

TEST(QualityChoice, ThreeSlowPicturesInARowAreEnough) {
  QualityChoice choice;
  add(choice, 5, 20.0);
  add(choice, 2, 45.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
  add(choice, 1, 45.0);
  EXPECT_EQ(choice.now(), Quality::kFast);
}

TEST(QualityChoice, TheFirstPictureOfALevelDoesNotCount) {
  QualityChoice choice;
  choice.add(400.0);  // includes the compilation of shaders
  add(choice, 1000, 30.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
}

TEST(QualityChoice, OneSlowPictureChangesNothing) {
  QualityChoice choice;
  add(choice, 50, 20.0);
  choice.add(90.0);
  add(choice, 50, 20.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
}

TEST(QualityChoice, ComesBackWhenThereIsRoomAndDoesNotSwing) {
  QualityChoice choice;
  int changes = 0;
  Quality before = choice.now();
  for (int i = 0; i < 4000; ++i) {
    choice.add(choice.now() == Quality::kBalanced ? 45.0 : 15.0);  // always over the budget, while the lower
                                                                   // level is far below it
    if (choice.now() != before) ++changes;
    before = choice.now();
  }
  EXPECT_LE(changes, 14);
  add(choice, 4000, 10.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
}

TEST(QualityChoice, NeverExceedsTheBestThatItMayChoose) {
  QualityChoice choice(Quality::kBalanced);
  add(choice, 1000, 1.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
  QualityChoice strong(Quality::kFull);
  add(strong, 1000, 1.0);
  EXPECT_EQ(strong.now(), Quality::kFull);
}

TEST(QualityChoice, GoesNoHigherThanItsLimit) {
  QualityChoice choice;
  choice.limit(Quality::kFast);
  EXPECT_EQ(choice.now(), Quality::kFast);
  add(choice, 4000, 1.0);
  EXPECT_EQ(choice.now(), Quality::kFast);
  choice.limit(Quality::kBalanced);
  EXPECT_EQ(choice.now(), Quality::kFast) << "it rises by the time that pictures take";
  add(choice, 4000, 1.0);
  EXPECT_EQ(choice.now(), Quality::kBalanced);
}

}  // namespace
}  // namespace palpate::render
