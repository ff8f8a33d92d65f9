// The shadow of a tool on the organ: the picture without the tool less the picture with it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/signed_distance.h"
#include "palpate/builtin.h"
#include "palpate/offscreen.h"
#include "palpate/surface.h"

namespace palpate::render {
namespace {

constexpr std::size_t kWide = 480;
constexpr std::size_t kHigh = 360;
constexpr double kShadowed = 12.0;  // of 255: darker than this is in the shadow
constexpr double kSpeck = 10.0;     // of 255: a shadow this far from the mean of its neighbours is a speck

// A ball of 3 mm radius, 6 mm over the top of the gallbladder, which it does not deform.
struct Hovering {
  Subject subject;
  haptics::Snapshot snapshot;
  Camera camera;
};

Hovering hovering_ball() {
  Hovering scene;
  scene.subject.organ = geometry::make_organ("gallbladder");
  scene.subject.tools = {geometry::make_tool("sphere:3")};
  scene.subject.tissue_name = "gallbladder";
  const geometry::Bounds box = geometry::bounds(scene.subject.organ);
  const geometry::NearestPoint top =
      geometry::SignedDistance(scene.subject.organ)
          .nearest(Vec3(box.middle().x(), box.middle().y(), box.high.z() + 0.02));
  scene.snapshot.hands = 1;
  scene.snapshot.tools[0].pose_W.position = top.point + 0.009 * top.normal;
  scene.camera = frame_contact(scene.subject, scene.snapshot, top.point, top.normal, true);
  return scene;
}

Image drawn(const Hovering& scene, Quality quality, std::uint32_t hands) {
  OffscreenRenderer renderer(scene.subject, static_cast<int>(kWide), static_cast<int>(kHigh), quality);
  haptics::Snapshot snapshot = scene.snapshot;
  snapshot.hands = hands;
  return renderer.draw(snapshot, scene.camera);
}

// How much darker the tool makes each pixel of the organ, mean of its colours. The ball is seen before the
// background, which is bluish where the organ is yellow.
std::vector<double> shadow_of(const Hovering& scene, Quality quality) {
  const Image bare = drawn(scene, quality, 0);
  const Image shaded = drawn(scene, quality, 1);
  std::vector<double> shadow(kWide * kHigh);
  for (std::size_t i = 0; i < shadow.size(); ++i) {
    if (bare.rgb[3 * i] <= bare.rgb[3 * i + 2]) continue;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) shadow[i] += (bare.rgb[c] - shaded.rgb[c]) / 3.0;
  }
  return shadow;
}

double area_of(const std::vector<double>& shadow) {
  return static_cast<double>(
      std::count_if(shadow.begin(), shadow.end(), [](double dark) { return dark > kShadowed; }));
}

// Fraction of the shadow's pixels that differ from the mean of their four neighbours, which are all in it.
double specks_in(const std::vector<double>& shadow) {
  double inside = 0.0;
  double specks = 0.0;
  for (std::size_t y = 1; y + 1 < kHigh; ++y) {
    for (std::size_t x = 1; x + 1 < kWide; ++x) {
      const std::size_t i = y * kWide + x;
      const auto [least, most] =
          std::minmax({shadow[i - 1], shadow[i + 1], shadow[i - kWide], shadow[i + kWide]});
      if (!(most > kShadowed) || least <= 0.0) continue;
      inside += 1.0;
      const double mean = (shadow[i - 1] + shadow[i + 1] + shadow[i - kWide] + shadow[i + kWide]) / 4.0;
      if (std::abs(shadow[i] - mean) > kSpeck) specks += 1.0;
    }
  }
  return inside > 0.0 ? specks / inside : 1.0;
}

class ToolShadow : public testing::TestWithParam<Quality> {
 protected:
  static void SetUpTestSuite() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
  }
};

TEST_P(ToolShadow, IsAsLargeAsInAStillPicture) {
  const Hovering scene = hovering_ball();
  const double still = area_of(shadow_of(scene, Quality::kFull));
  ASSERT_GT(still, 500.0);
  EXPECT_NEAR(area_of(shadow_of(scene, GetParam())) / still, 1.0, 0.3);
}

TEST_P(ToolShadow, HasNoSpecks) { EXPECT_LT(specks_in(shadow_of(hovering_ball(), GetParam())), 0.01); }

INSTANTIATE_TEST_SUITE_P(Both, ToolShadow, testing::Values(Quality::kBalanced, Quality::kFast),
                         [](const auto& info) { return info.param == Quality::kFast ? "Fast" : "Balanced"; });

}  // namespace
}  // namespace palpate::render
