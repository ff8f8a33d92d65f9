#include "app/window/resolution_choice.h"

#include <gtest/gtest.h>

namespace palpate::app {
namespace {

constexpr bool kMayCheapen = true;
constexpr bool kCheapest = false;

/// Adds this many frames of equal time. @return the last result
bool add(ResolutionChoice& choice, int frames, double time, bool may_cheapen = kCheapest) {
  bool fits = false;
  for (int i = 0; i < frames; ++i) fits = choice.add(time, may_cheapen);
  return fits;
}

TEST(ResolutionChoice, DrawsAllPixelsWhileFramesFitTheBudget) {
  ResolutionChoice choice;
  EXPECT_TRUE(add(choice, 800, 0.029));
  EXPECT_TRUE(choice.all());
  EXPECT_EQ(choice.now(), 1.0);
}

TEST(ResolutionChoice, GoesDownAStepWhenMostOfEightFramesWereSlow) {
  ResolutionChoice choice;
  add(choice, 4, 0.010);
  add(choice, 3, 0.050);
  EXPECT_FALSE(choice.add(0.050, kCheapest));
  EXPECT_EQ(choice.now(), 0.8);
  add(choice, 5, 0.029);
  EXPECT_TRUE(add(choice, 3, 0.050));
  EXPECT_EQ(choice.now(), 0.8) << "most of these were not";
}

TEST(ResolutionChoice, CheaperPicturesComeFirst) {
  ResolutionChoice choice;
  EXPECT_FALSE(add(choice, 80, 0.060, kMayCheapen));
  EXPECT_TRUE(choice.all());
  add(choice, 8, 0.120, kMayCheapen);
  EXPECT_EQ(choice.now(), 0.65) << "frames more than three times too slow";
}

TEST(ResolutionChoice, EndsAtItsLowestAndSaysThatNothingIsLeft) {
  ResolutionChoice choice;
  add(choice, 80, 0.2);
  EXPECT_EQ(choice.now(), 0.4);
  EXPECT_TRUE(add(choice, 8, 0.2)) << "as good as it gets";
  EXPECT_FALSE(choice.lower());
}

TEST(ResolutionChoice, FewFramesAreEnoughWhereItIsAskedToBeQuick) {
  ResolutionChoice choice;
  EXPECT_FALSE(choice.add(0.05, kCheapest, ResolutionChoice::kFew));
  EXPECT_FALSE(choice.add(0.05, kCheapest, ResolutionChoice::kFew));
  EXPECT_EQ(choice.now(), 1.0);
  EXPECT_FALSE(choice.add(0.05, kCheapest, ResolutionChoice::kFew));
  EXPECT_EQ(choice.now(), 0.8);
}

TEST(ResolutionChoice, ComesBackWhenThereIsRoomAndDoesNotSwing) {
  ResolutionChoice choice;
  int changes = 0;
  double before = choice.now();
  for (int i = 0; i < 16'000; ++i) {
    choice.add(choice.now() > 0.5 ? 0.045 : 0.020, kCheapest);  // only the lower resolutions fit
    if (choice.now() != before) ++changes;
    before = choice.now();
  }
  EXPECT_LE(changes, 28);
  EXPECT_GE(changes, 10) << "it tries again";
  add(choice, 16'000, 0.010);
  EXPECT_TRUE(choice.all());
}

}  // namespace
}  // namespace palpate::app
