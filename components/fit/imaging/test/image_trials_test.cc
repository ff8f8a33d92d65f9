// Random trials with known answers: each kind of degradation alone, then all together.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/statistics.h"
#include "palpate/error.h"

#include "fit/imaging/image_measure.h"
#include "fit/imaging/robust.h"
#include "fit/imaging/test/image_scene.h"

namespace palpate::imaging {
namespace {

using test::SideView;

struct Pair {
  SideView before;
  SideView after;
};

using Degrade = std::function<void(Random&, Pair&)>;

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

/// Applies a change to both views.
template <typename Change>
void both(Pair& pair, const Change& change) {
  change(pair.before);
  change(pair.after);
}

Pair random_pair(Random& random, std::uint32_t seed) {
  Pair pair;
  SideView view;
  view.seed = 100 + seed;
  view.depth_mm = between(random, 2.0, 8.0);
  view.tip_mm = between(random, 2.0, 4.0);
  view.centre_x = between(random, 380.0, 520.0);
  view.surface_y = between(random, 170.0, 230.0);
  view.dome = random.uniform() < 0.5 ? 0.0 : between(random, 20.0, 160.0);
  view.above = between(random, 0.65, 0.9);
  view.below = between(random, 0.25, 0.5);
  if (random.uniform() < 0.3) std::swap(view.above, view.below);
  view.texture = between(random, 0.005, 0.03);
  view.instrument_light = between(random, 0.05, 0.95);
  pair.before = view;
  pair.before.depth_mm = 0.0;
  pair.before.instrument = false;
  pair.after = view;
  pair.after.seed += 1000;  // noise and grain differ
  return pair;
}

struct Outcome {
  bool refused = false;
  std::string why;
  double median_error = 0.0;  // px
  double p95_error = 0.0;
  double held = 0.0;         // fraction of points within their stated uncertainty
  double uncertainty = 0.0;  // px, median
  int confidence = 0;
};

Outcome measure_trial(const Pair& pair) {
  Outcome outcome;
  ImageSettings settings;
  settings.pixel = pair.after.mm_per_px * 1e-3;
  try {
    const ImageMeasurement found = measure_pictures(
        test::photograph(pair.before), test::photograph(pair.after), settings, "before.png", "after.png");
    std::vector<double> errors;
    int held = 0;
    for (const ImagePoint& point : found.points) {
      const double error =
          std::abs(point.u / settings.pixel - test::true_u(pair.after, point.r / settings.pixel));
      errors.push_back(error);
      held += error <= point.uncertainty / settings.pixel ? 1 : 0;
    }
    std::sort(errors.begin(), errors.end());
    outcome.median_error = median(errors);
    outcome.p95_error = errors[static_cast<std::size_t>(0.95 * static_cast<double>(errors.size() - 1))];
    outcome.held = static_cast<double>(held) / static_cast<double>(errors.size());
    outcome.uncertainty = found.uncertainty / settings.pixel;
    outcome.confidence = found.confidence;
  } catch (const InputError& error) {
    outcome.refused = true;
    outcome.why = error.what();
  }
  return outcome;
}

struct Kind {
  std::string name;
  Degrade degrade;
};

void add_spots(Random& random, Pair& pair) {
  for (SideView* view : {&pair.before, &pair.after}) {
    for (int i = 0; i < 9; ++i) {
      view->spots.push_back(
          {between(random, 20.0, 880.0), between(random, -2.0, 40.0), between(random, 3.0, 9.0)});
    }
  }
}

void add_bars(Random& random, Pair& pair) {
  pair.after.bar_width = between(random, 20.0, 70.0);
  pair.after.bars = {pair.after.centre_x + between(random, -250.0, 250.0)};
  if (random.uniform() < 0.5) pair.before.bars = {between(random, 50.0, 850.0)};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"as drawn", [](Random&, Pair&) {}},
      {"blur, 3 px", [](Random&, Pair& pair) { both(pair, [](SideView& v) { v.blur = 3.0; }); }},
      {"noise, 8 % of white", [](Random&, Pair& pair) { both(pair, [](SideView& v) { v.noise = 0.08; }); }},
      {"JPEG, quality 20", [](Random&, Pair& pair) { both(pair, [](SideView& v) { v.jpeg = 20; }); }},
      {"both tilted by 5 degrees",
       [](Random& random, Pair& pair) {
         const double turn = (random.uniform() < 0.5 ? -5.0 : 5.0) * M_PI / 180.0;
         both(pair, [turn](SideView& v) { v.turn = turn; });
       }},
      {"second turned by up to 5 degrees, shifted",
       [](Random& random, Pair& pair) {
         pair.after.turn = between(random, -5.0, 5.0) * M_PI / 180.0;
         pair.after.shift_x = between(random, -10.0, 10.0);
         pair.after.shift_y = between(random, -10.0, 10.0);
       }},
      {"specular spots", add_spots},
      {"partly hidden", add_bars},
      {"uneven light, 50 %", [](Random&, Pair& pair) { both(pair, [](SideView& v) { v.uneven = 0.5; }); }},
      {"all together, less of each",
       [](Random& random, Pair& pair) {
         add_spots(random, pair);
         add_bars(random, pair);
         const double turn = between(random, -4.0, 4.0) * M_PI / 180.0;
         both(pair, [turn](SideView& v) {
           v.turn = turn;
           v.uneven = 0.3;
           v.blur = 1.2;
           v.noise = 0.03;
           v.jpeg = 60;
         });
         pair.after.turn += between(random, -1.0, 1.0) * M_PI / 180.0;
       }},
  };
  return all;
}

/// PALPATE_IMAGE_TRIALS pairs per kind (default 4, for CI); tools/update_image_accuracy uses more.
int trials() {
  const char* asked = std::getenv("PALPATE_IMAGE_TRIALS");
  return asked == nullptr ? 4 : std::max(1, std::atoi(asked));
}

class ImageTrials : public testing::TestWithParam<std::size_t> {};

TEST_P(ImageTrials, AreNeverSilentlyWrong) {
  const Kind& kind = kinds()[GetParam()];
  std::vector<Outcome> seen;
  int refused = 0;
  for (int trial = 0; trial < trials(); ++trial) {
    Random random(2024, static_cast<std::uint32_t>(GetParam()), static_cast<std::uint32_t>(trial));
    Pair pair = random_pair(random, static_cast<std::uint32_t>(trial));
    kind.degrade(random, pair);
    const Outcome outcome = measure_trial(pair);
    if (outcome.refused) {
      ++refused;
      continue;
    }
    seen.push_back(outcome);
    EXPECT_GE(outcome.held, 0.85) << kind.name << ", trial " << trial << ": errors beyond what was stated";
  }
  ASSERT_FALSE(seen.empty());
  std::vector<double> errors;
  std::vector<double> uncertainties;
  double p95 = 0.0;
  double held = 0.0;
  double least_held = 1.0;
  for (const Outcome& outcome : seen) {
    errors.push_back(outcome.median_error);
    uncertainties.push_back(outcome.uncertainty);
    p95 = std::max(p95, outcome.p95_error);
    held += outcome.held / static_cast<double>(seen.size());
    least_held = std::min(least_held, outcome.held);
  }
  std::printf("| %s | %d | %d | %.2f | %.2f | %.2f | %.0f %% | %.0f %% |\n", kind.name.c_str(), trials(),
              refused, median(errors), p95, median(uncertainties), 100.0 * held, 100.0 * least_held);
  EXPECT_LT(median(errors), 0.5);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, ImageTrials, testing::Range<std::size_t>(0, 10));

}  // namespace
}  // namespace palpate::imaging
