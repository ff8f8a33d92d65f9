// A renderer that draws only what changed must give the same pictures as one that draws all of each.
#include "view/render/changed_region.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/contact.h"
#include "core/geometry/signed_distance.h"
#include "palpate/builtin.h"
#include "palpate/offscreen.h"
#include "palpate/surface.h"

namespace palpate::render {
namespace {

constexpr int kShownWidth = 400;
constexpr int kShownHeight = 300;
constexpr int kPictures = 30;

struct Press {
  Subject subject;
  std::vector<haptics::Snapshot> moments;
  Camera camera;
};

// An instrument that comes from above, presses 6 mm deep, slides, turns, opens and closes, and leaves. With
// two hands the second instrument rests beside it and touches nothing.
Press computed_press(const std::string& organ, const std::string& tool, std::size_t hands) {
  Press press;
  press.subject.organ = geometry::make_organ(organ);
  press.subject.tissue_name = organ;
  press.subject.tools.assign(hands, geometry::make_tool(tool));
  const geometry::Bounds box = geometry::bounds(press.subject.organ);
  const geometry::NearestPoint top =
      geometry::SignedDistance(press.subject.organ)
          .nearest(Vec3(box.middle().x(), box.middle().y(), box.high.z() + 0.02));
  const contact::World world(press.subject.organ, press.subject.tools, model::tissue_preset(organ), 1e-3);
  contact::State state(world);
  std::vector<contact::ToolInput> inputs(hands);
  const Quat down(Eigen::AngleAxisd(0.9, Vec3(1.0, 0.4, 0.0).normalized()));
  for (contact::ToolInput& input : inputs) input.pose_W = {down, top.point + Vec3(0.012, 0.016, 0.02)};
  constexpr int kStepsAPicture = 30;
  for (int step = 0; step < kPictures * kStepsAPicture; ++step) {
    const double t = static_cast<double>(step) / (kPictures * kStepsAPicture);
    const double height = 0.004 - 0.010 * std::sin(3.14159 * t);
    const Vec3 side(0.006 * std::sin(9.0 * t), 0.0, 0.0);
    inputs[0].pose_W.position = top.point + height * top.normal + side;
    inputs[0].pose_W.rotation = Quat(Eigen::AngleAxisd(0.3 * t, Vec3::UnitZ())) * down;
    inputs[0].gripper = 0.5 + 0.5 * std::sin(12.0 * t);
    haptics::Snapshot snapshot;
    contact::advance(world, Pose{}, inputs, state, std::span(snapshot.results.data(), hands));
    if (step % kStepsAPicture != 0) continue;
    snapshot.hands = static_cast<std::uint32_t>(hands);
    for (std::size_t hand = 0; hand < hands; ++hand) snapshot.tools[hand] = inputs[hand];
    press.moments.push_back(snapshot);
  }
  press.camera = frame_contact(press.subject, press.moments[kPictures / 2], top.point, top.normal, false);
  return press;
}

// The press of this organ, computed once: most of a test's time would be the preparation of its contact.
const Press& press_of(const std::string& organ, const std::string& tool, std::size_t hands = 1) {
  static std::map<std::tuple<std::string, std::string, std::size_t>, Press> known;
  const auto [at, is_new] = known.try_emplace({organ, tool, hands});
  if (is_new) at->second = computed_press(organ, tool, hands);
  return at->second;
}

using Change = std::function<void(OffscreenRenderer&, std::size_t)>;

// A renderer that draws what changed, and one that is made to draw all.
struct Pair {
  explicit Pair(const Subject& subject)
      : partial(subject, kShownWidth, kShownHeight, Quality::kBalanced),
        whole(subject, kShownWidth, kShownHeight, Quality::kBalanced) {}
  Pair& hold(Quality quality) {
    partial.hold_quality(quality);
    whole.hold_quality(quality);
    return *this;
  }

  OffscreenRenderer partial;
  OffscreenRenderer whole;
};

// Number of pictures in which the two differ. @param change applied to both before each picture
int different_pictures(Pair& pair, const Press& press, const Change& change = {}) {
  auto& [partial, whole] = pair;
  int different = 0;
  for (std::size_t i = 0; i < press.moments.size(); ++i) {
    if (change) {
      change(partial, i);
      change(whole, i);
    }
    whole.redraw_all();
    const Image expected = whole.draw(press.moments[i], press.camera);
    if (partial.draw(press.moments[i], press.camera).rgb != expected.rgb) ++different;
  }
  return different;
}

class ChangedPart : public testing::TestWithParam<Quality> {
 protected:
  static void SetUpTestSuite() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
  }
  static void TearDownTestSuite() { pairs_.clear(); }
  // The renderers of this press in this test's quality, made once: they take longer than several pictures.
  static Pair& pair_of(const Press& press) {
    std::unique_ptr<Pair>& pair = pairs_[&press];
    if (pair == nullptr) pair = std::make_unique<Pair>(press.subject);
    return pair->hold(GetParam());
  }

 private:
  static inline std::map<const Press*, std::unique_ptr<Pair>> pairs_;
};

TEST_P(ChangedPart, OfAPressIsThePictureOfAFullRedrawBitForBit) {
  const Press& press = press_of("gallbladder", "curved-forceps");
  EXPECT_EQ(different_pictures(pair_of(press), press), 0);
}

TEST_P(ChangedPart, OfAPressOnTheHeartIsThePictureOfAFullRedrawBitForBit) {
  const Press& press = press_of("heart", "sphere:3");
  EXPECT_EQ(different_pictures(pair_of(press), press), 0);
}

TEST_P(ChangedPart, IncludesTheShadowOnAnInstrumentThatRests) {
  const Press& press = press_of("liver", "curved-forceps", 2);
  EXPECT_EQ(different_pictures(pair_of(press), press), 0);
}

TEST_P(ChangedPart, IsAllOfThePictureAfterAChangeOfSettings) {
  const Press& press = press_of("gallbladder", "curved-forceps");
  const Vec3 marked = press.moments[kPictures / 2].results[0].contact_W;
  const auto change = [marked](OffscreenRenderer& renderer, std::size_t picture) {
    if (picture == 4) renderer.set_map_range(0.01);
    if (picture == 6) renderer.set_map_range(0.0);
    if (picture == 8) renderer.show_marks({{marked, SurfaceMark::Kind::kFound}});
    if (picture == 10) renderer.show_inclusions({{marked, 0.01, 2.0}});
    if (picture == 12) renderer.show_values({{marked}, {0.5F}, 0.0, 1.0});
    if (picture == 14) renderer.update_values(std::vector<float>{0.9F});
    if (picture == 16) renderer.switch_lamps(false);
    if (picture == 19) renderer.resize(kShownHeight, kShownWidth);
    if (picture == 22) renderer.hold_quality(Quality::kFull);
    if (picture == 24) renderer.hold_quality(Quality::kFast);
    if (picture == 26) renderer.hold_quality(Quality::kBalanced);
  };
  Pair pair(press.subject);
  EXPECT_EQ(different_pictures(pair.hold(GetParam()), press, change), 0);
}

TEST_P(ChangedPart, IsAllOfThePictureWhereTheOrganMoves) {
  const Press& still = press_of("gallbladder", "curved-forceps");
  Press press = still;
  for (std::size_t i = 10; i < 15; ++i)
    press.moments[i].organ_W.position.z() += 2e-4 * static_cast<double>(i);
  EXPECT_EQ(different_pictures(pair_of(still), press), 0);
}

TEST_P(ChangedPart, IsAllOfThePictureWhereTheCameraMoves) {
  const Press& press = press_of("gallbladder", "curved-forceps");
  auto& [partial, whole] = pair_of(press);
  Camera camera = press.camera;
  for (std::size_t i = 0; i < press.moments.size(); ++i) {
    if (i % 7 < 2) camera.eye.x() += 0.003;
    whole.redraw_all();
    const Image expected = whole.draw(press.moments[i], camera);
    ASSERT_EQ(partial.draw(press.moments[i], camera).rgb, expected.rgb) << i;
  }
}

TEST_P(ChangedPart, HasTheDrapeAsItsOwnCameraSeesIt) {
  const Press& press = press_of("gallbladder", "curved-forceps");
  OffscreenRenderer turned(press.subject, kShownWidth, kShownHeight, GetParam());
  OffscreenRenderer fresh(press.subject, kShownWidth, kShownHeight, GetParam());
  turned.show_drape(true);
  fresh.show_drape(true);
  Camera camera = press.camera;
  static_cast<void>(turned.draw(press.moments[0], camera));  // before the contact
  camera.eye.x() += 0.02;
  for (const std::size_t i : {1, 2})
    EXPECT_TRUE(turned.draw(press.moments[i], camera).rgb == fresh.draw(press.moments[i], camera).rgb) << i;
  turned.show_drape(false);
  EXPECT_TRUE(turned.draw(press.moments[2], camera).rgb != fresh.draw(press.moments[2], camera).rgb);
}

TEST_P(ChangedPart, IsRightWhereAnInstrumentPassesTheCamera) {
  const Press& outside = press_of("gallbladder", "curved-forceps");
  Press press = outside;
  for (std::size_t i = 0; i < press.moments.size(); ++i) {
    const double t = static_cast<double>(i) / kPictures;
    press.moments[i].tools[0].pose_W.position =
        press.camera.target + t * 1.2 * (press.camera.eye - press.camera.target);
    press.moments[i].results[0].view_count = 0;
  }
  EXPECT_EQ(different_pictures(pair_of(outside), press), 0);
}

INSTANTIATE_TEST_SUITE_P(Both, ChangedPart, testing::Values(Quality::kBalanced, Quality::kFast),
                         [](const auto& info) { return info.param == Quality::kFast ? "Fast" : "Balanced"; });

TEST(ChangedShadow, FallsOnWhatIsBehindTheCasterAndNotBeforeOrBesideIt) {
  ChangedShadow shadow;
  const ScreenBox caster{100.0F, 100.0F, 110.0F, 110.0F};
  shadow.add(caster, 0.5F, true);
  EXPECT_TRUE(shadow.falls_on(caster, 0.6F));
  EXPECT_FALSE(shadow.falls_on(caster, 0.4F));
  EXPECT_FALSE(shadow.falls_on({130.0F, 100.0F, 140.0F, 110.0F}, 0.6F));
}

TEST(ChangedShadow, FallsOnWhatIsBehindACasterThatRestsBesideOneThatMoved) {
  ChangedShadow shadow;
  const ScreenBox moved{100.0F, 100.0F, 110.0F, 110.0F};
  const ScreenBox far_away{180.0F, 100.0F, 190.0F, 110.0F};
  shadow.add(moved, 0.5F, true);
  shadow.add({104.0F, 104.0F, 190.0F, 110.0F}, 0.3F, false);
  EXPECT_TRUE(shadow.falls_on(moved, 0.4F));
  EXPECT_FALSE(shadow.falls_on(moved, 0.2F));
  EXPECT_FALSE(shadow.falls_on(far_away, 0.9F)) << "nothing moved there";
}

TEST(ChangedShadow, ReachesAsFarAsTheMapIsSoftened) {
  ChangedShadow shadow;
  shadow.add({100.0F, 100.0F, 110.0F, 110.0F}, 0.5F, true);
  constexpr float kReached = 110.0F + ChangedShadow::kBlur + 0.9F;
  EXPECT_TRUE(shadow.falls_on({kReached, 105.0F, 140.0F, 106.0F}, 0.6F));
}

TEST(ChangedShadow, OfACasterBesideTheMapFallsOnWhatLiesBesideItThere) {
  ChangedShadow shadow;
  shadow.add({-50.0F, 100.0F, -40.0F, 110.0F}, 0.5F, true);
  EXPECT_TRUE(shadow.falls_on({-90.0F, 104.0F, -80.0F, 106.0F}, 0.6F));
}

}  // namespace
}  // namespace palpate::render
