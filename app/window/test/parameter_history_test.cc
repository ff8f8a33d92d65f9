// Undo and redo, without a display.
#include "app/window/parameter_history.h"

#include <gtest/gtest.h>

#include "palpate/tissue.h"

namespace palpate::app {
namespace {

LiveParameters with_stiffness(double k1) {
  scene::Scene scene;
  scene.tissue = model::tissue_preset("liver");
  scene.tissue.k1 = k1;
  return LiveParameters(scene);
}

double k1_of(const std::optional<LiveParameters>& parameters) {
  return parameters ? parameters->tissue.k1 : 0.0;
}

TEST(ParameterHistory, UndoesAndRedoesInOrder) {
  ParameterHistory history;
  history.add(with_stiffness(1.0), false);
  history.add(with_stiffness(2.0), false);
  EXPECT_EQ(k1_of(history.undo(with_stiffness(3.0))), 2.0);
  EXPECT_EQ(k1_of(history.undo(with_stiffness(2.0))), 1.0);
  EXPECT_FALSE(history.undo(with_stiffness(1.0)));
  EXPECT_EQ(k1_of(history.redo(with_stiffness(1.0))), 2.0);
  EXPECT_EQ(k1_of(history.redo(with_stiffness(2.0))), 3.0);
  EXPECT_FALSE(history.redo(with_stiffness(3.0)));
}

TEST(ParameterHistory, ADragIsOneStepAndTheNextDragAnother) {
  ParameterHistory history;
  for (const double k1 : {1.0, 1.1, 1.2}) {
    history.next_frame(true);
    history.add(with_stiffness(k1), true);
  }
  history.next_frame(false);  // released
  history.next_frame(true);
  history.add(with_stiffness(2.0), true);
  EXPECT_EQ(k1_of(history.undo(with_stiffness(3.0))), 2.0);
  EXPECT_EQ(k1_of(history.undo(with_stiffness(2.0))), 1.0);
  EXPECT_FALSE(history.can_undo());
}

TEST(ParameterHistory, AChangeAfterUndoForgetsWhatCouldBeRedone) {
  ParameterHistory history;
  history.add(with_stiffness(1.0), false);
  (void)history.undo(with_stiffness(2.0));
  EXPECT_TRUE(history.can_redo());
  history.add(with_stiffness(1.0), false);
  EXPECT_FALSE(history.can_redo());
}

TEST(ParameterHistory, NoiseAndInclusionsAreSteps) {
  LiveParameters first = with_stiffness(1.0);
  first.inclusions.emplace_back();
  LiveParameters second = first;
  second.noise.enabled = !first.noise.enabled;
  LiveParameters third = second;
  third.inclusions[0].inclusion.ratio += 1.0;
  EXPECT_FALSE(equal(first, second));
  EXPECT_FALSE(equal(second, third));
  EXPECT_TRUE(equal(third, third));
}

TEST(ParameterHistory, KeepsTheNewestStepsOnly) {
  ParameterHistory history;
  for (std::size_t i = 0; i < ParameterHistory::kMaxSteps + 5; ++i) {
    history.add(with_stiffness(1.0 + static_cast<double>(i)), false);
  }
  std::size_t steps = 0;
  LiveParameters now = with_stiffness(0.5);
  while (const std::optional<LiveParameters> before = history.undo(now)) {
    now = *before;
    ++steps;
  }
  EXPECT_EQ(steps, ParameterHistory::kMaxSteps);
  EXPECT_EQ(now.tissue.k1, 6.0);
}

}  // namespace
}  // namespace palpate::app
