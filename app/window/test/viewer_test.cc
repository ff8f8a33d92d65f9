// The viewer's real window on a display that Xvfb draws to memory, driven by synthetic events.
#include "app/window/viewer.h"

#include <algorithm>
#include <cmath>

#include "app/window/test/window_fixture.h"

namespace palpate::app {
namespace {

using ::testing::HasSubstr;

class ViewerTest : public WindowTest {
 protected:
  /// Records 7 s of a press, faster than real time.
  std::filesystem::path recorded(const std::string& name, const scene::Overrides& request) {
    (void)Session(scene::load(request)).run({file(name), true});
    return file(name);
  }
  /// The same of a press on the ball, recorded once for all tests.
  std::filesystem::path recorded(const std::string& name) {
    static const test::TemporaryFolder common;
    const std::filesystem::path press = common.path() / "press.h5";
    if (!std::filesystem::exists(press)) (void)Session(scene::load(ball("scripted"))).run({press, true});
    std::filesystem::copy_file(press, file(name));
    return file(name);
  }
  static ViewerOptions small_viewer() {
    ViewerOptions options;
    options.size = {500, 320};
    options.scale = 0.5F;
    return options;
  }
};

TEST_F(ViewerTest, ShowsTheMomentsThatItIsAskedForByKeys) {
  if (!display_is_there()) return;
  DrivenViewer driven(recorded("a.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  EXPECT_EQ(viewer.snapshot().tick, 0U);
  const HandOverview& hand = viewer.overview().hands[0];
  const auto expect_at = [&](std::uint64_t tick, const char* why) {
    ASSERT_TRUE(driven.until_there());
    EXPECT_EQ(viewer.snapshot().tick, tick) << why;
  };
  driven.key(SDLK_d);
  expect_at(hand.deepest, "deepest");
  EXPECT_EQ(viewer.snapshot().results[0].depth, viewer.view().row(hand.deepest, 0).depth);
  EXPECT_EQ(1e3 * viewer.snapshot().results[0].depth, hand.deepest_mm);
  driven.key(SDLK_c);
  expect_at(hand.contacts.front().first, "first contact");
  driven.key(SDLK_LEFT, KMOD_SHIFT);
  expect_at(hand.contacts.front().first - 1, "a tick back");
  EXPECT_EQ(viewer.snapshot().results[0].phase, contact::Phase::kApproach);
  driven.key(SDLK_RIGHT);
  expect_at(hand.contacts.front().first + 32, "a picture on, of 33 ticks");
  driven.key(SDLK_RIGHT, KMOD_CTRL);
  expect_at(hand.contacts.front().first + 1032, "a second on");
  driven.key(SDLK_END);
  expect_at(viewer.view().ticks() - 1, "the end");
  driven.key(SDLK_HOME);
  expect_at(0, "the beginning");
  driven.key(SDLK_f);
  driven.frames(1);
  EXPECT_THAT(viewer.message(), HasSubstr("no fault"));
  driven.key(SDLK_F1);
  EXPECT_TRUE(viewer.state().help);
  driven.key(SDLK_ESCAPE);
  EXPECT_TRUE(driven.alive()) << "the first Esc closes the keys";
  driven.key(SDLK_ESCAPE);
  EXPECT_FALSE(driven.alive());
}

TEST_F(ViewerTest, NumbersPlotsAndPictureAreOfTheSameTick) {
  if (!display_is_there()) return;
  DrivenViewer driven(recorded("a.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  driven.key(SDLK_END);
  ASSERT_TRUE(driven.until([&] { return viewer.snapshot().tick == viewer.view().ticks() - 1; }));
  const std::vector<std::uint8_t> plots = cut_out(viewer.picture(), viewer.layout().plots);
  driven.frames(1);
  EXPECT_EQ(cut_out(viewer.picture(), viewer.layout().plots), plots) << "nothing was left to catch up with";
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, PlaysPausesAndSlowsDown) {
  if (!display_is_there()) return;
  DrivenViewer driven(recorded("a.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  driven.key(SDLK_DOWN);
  driven.key(SDLK_DOWN);
  EXPECT_EQ(Playback::kSpeeds[viewer.playback().speed()], 0.25);
  driven.key(SDLK_SPACE);
  EXPECT_TRUE(viewer.playback().playing());
  ASSERT_TRUE(driven.until([&] { return viewer.snapshot().tick > 100; }));
  driven.key(SDLK_SPACE);
  EXPECT_FALSE(viewer.playback().playing());
  ASSERT_TRUE(driven.until_there());
  const std::uint64_t stopped = viewer.snapshot().tick;
  driven.frames(3);
  EXPECT_EQ(viewer.snapshot().tick, stopped);
  driven.key(SDLK_END);
  ASSERT_TRUE(driven.until_there());
  driven.key(SDLK_SPACE);
  ASSERT_TRUE(driven.until([&] { return viewer.snapshot().tick > 10 && viewer.snapshot().tick < 6000; }))
      << "from the beginning again";
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, IsScrubbedByTheMouse) {
  if (!display_is_there()) return;
  DrivenViewer driven(recorded("a.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  ASSERT_TRUE(driven.point_at({"timeline", "strip"}));
  const Rectangle& place = viewer.layout().timeline;
  const int y = static_cast<int>(place.y + 0.7F * place.height);
  const auto share = [&] {
    return static_cast<double>(viewer.snapshot().tick) / static_cast<double>(viewer.view().ticks());
  };
  driven.move(static_cast<int>(place.x + 0.25F * place.width), y);
  driven.frames(1);
  driven.button(SDL_BUTTON_LEFT, true);
  driven.frames(2);
  ASSERT_TRUE(driven.until_there());
  EXPECT_NEAR(share(), 0.25, 0.02);
  driven.move(static_cast<int>(place.x + 0.75F * place.width), y);
  ASSERT_TRUE(driven.until_there());
  EXPECT_NEAR(share(), 0.75, 0.02);
  driven.move(static_cast<int>(place.x + 0.5F * place.width), static_cast<int>(place.y) - 100);
  ASSERT_TRUE(driven.until_there());
  EXPECT_NEAR(share(), 0.5, 0.02) << "held on to outside the strip, too";
  driven.button(SDL_BUTTON_LEFT, false);
  driven.frames(2);
  ASSERT_TRUE(driven.press({"timeline", "Deepest"}));
  ASSERT_TRUE(driven.until_there());
  EXPECT_EQ(viewer.snapshot().tick, viewer.overview().hands[0].deepest);
  ASSERT_TRUE(driven.press({"timeline", "1/10"}));
  EXPECT_EQ(viewer.playback().speed(), 0U);
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, TheMapAndTheViewChangeThePictureAndTheFirstViewComesBack) {
  if (!display_is_there()) return;
  DrivenViewer driven(recorded("a.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  driven.key(SDLK_d);
  ASSERT_TRUE(driven.until_there());
  ASSERT_TRUE(driven.until_still());
  const std::vector<std::uint8_t> first = viewer.still_picture().rgb;
  driven.key(SDLK_m);
  driven.frames(2);
  EXPECT_TRUE(viewer.state().map);
  EXPECT_NE(viewer.still_picture().rgb, first);
  driven.key(SDLK_m);
  driven.frames(2);
  EXPECT_EQ(viewer.still_picture().rgb, first);
  driven.move_to_middle(viewer.layout().picture);
  driven.frames(1);
  Driven::wheel(2);
  driven.frames(1);
  EXPECT_NE(viewer.still_picture().rgb, first) << "nearer";
  driven.key(SDLK_v);
  driven.frames(2);
  EXPECT_EQ(viewer.still_picture().rgb, first);
  driven.key(SDLK_RIGHT, KMOD_ALT);
  driven.frames(1);
  EXPECT_NE(viewer.still_picture().rgb, first) << "turned";
  driven.key(SDLK_z);
  driven.frames(1);
  EXPECT_NE(viewer.still_picture().rgb, first) << "close-up";
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, AnotherRecordingIsDroppedOntoItAndABadOneIsRefused) {
  if (!display_is_there()) return;
  const std::filesystem::path first = recorded("a.h5");
  scene::Overrides pull = ball("scripted");
  pull.tissue = "heart";
  const std::filesystem::path second = recorded("b.h5", pull);
  DrivenViewer driven(first, small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  Driven::drop(second.string());
  ASSERT_TRUE(driven.until([&] { return viewer.view().file() == second; }));
  ASSERT_TRUE(driven.until_there());
  EXPECT_EQ(viewer.view().recording().scene.tissue.name, "heart");
  std::ofstream(file("bad.h5")) << "no recording";
  Driven::drop(file("bad.h5").string());
  ASSERT_TRUE(driven.until([&] { return viewer.message().find("bad.h5") != std::string::npos; }));
  EXPECT_EQ(viewer.view().file(), second);
  Driven::drop(file("organ.stl").string());
  driven.frames(2);
  EXPECT_THAT(viewer.message(), HasSubstr("organ.stl"));
  driven.key(SDLK_o, KMOD_CTRL);
  driven.frames(2);
  EXPECT_TRUE(viewer.state().files.is_open());
  driven.type("a.h5");
  driven.key(SDLK_RETURN);
  ASSERT_TRUE(driven.until([&] { return viewer.view().file() == first; })) << viewer.message();
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, AFaultIsJumpedToAndSaidInWords) {
  if (!display_is_there()) return;
  const scene::Overrides lost = failing(file("lost.toml"), "freeze", "0.3", "0.2");
  (void)Session(scene::load(lost), {.duration_s = 1.0}).run({file("lost.h5"), true});
  DrivenViewer driven(file("lost.h5"), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  EXPECT_EQ(viewer.banner(), "");
  driven.key(SDLK_f);
  ASSERT_TRUE(driven.until_there());
  driven.frames(1);
  EXPECT_NEAR(viewer.view().time_of(viewer.snapshot().tick), 0.305, 0.005);
  EXPECT_EQ(viewer.banner(), "Zero force: the device gave no new sample for 5 ms");
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, AHandIsChosenAmongSeveral) {
  if (!display_is_there()) return;
  const std::filesystem::path scene = file("two.toml");
  std::ofstream(scene) << "[organ]\nmesh = \"ball\"\ntissue = \"liver\"\n"
                          "[[tool]]\nmesh = \"sphere:5\"\n[[tool]]\nmesh = \"sphere:3\"\n"
                          "[[device]]\nkind = \"scripted\"\n[[device]]\nkind = \"scripted\"\n";
  scene::Overrides request;
  request.scene = scene;
  DrivenViewer driven(recorded("two.h5", request), small_viewer());
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  driven.key(SDLK_1);
  driven.frames(1);
  EXPECT_EQ(viewer.state().hand, 1U);
  driven.key(SDLK_2);
  driven.frames(1);
  EXPECT_EQ(viewer.state().hand, 1U) << "there is no third";
  ASSERT_TRUE(driven.press({"left", "moment", "0"}));
  EXPECT_EQ(viewer.state().hand, 0U);
  ASSERT_NE(viewer.overview().hands[0].deepest, viewer.overview().hands[1].deepest);
  driven.key(SDLK_1);
  driven.key(SDLK_d);
  ASSERT_TRUE(driven.until_there());
  EXPECT_EQ(viewer.snapshot().tick, viewer.overview().hands[1].deepest);
  close_and_expect_order(driven);
}

TEST_F(ViewerTest, LivesThroughAnySizeAndScale) {
  if (!display_is_there()) return;
  ViewerOptions options = small_viewer();
  options.scale = 2.0F;
  DrivenViewer driven(recorded("a.h5"), options);
  Viewer& viewer = driven.viewer();
  ASSERT_TRUE(driven.until_there());
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(2880, 1800), std::pair(300, 900), std::pair(1000, 600)}) {
    const int wide = width;  // clang 14: a lambda cannot capture a structured binding
    Driven::resize(width, height);
    ASSERT_TRUE(driven.until([&] { return viewer.picture().width == wide; })) << wide;
    driven.frames(2);
    EXPECT_TRUE(driven.alive());
    if (width != 2880) continue;
    EXPECT_EQ(viewer.layout().left.width, 636.0F) << "panels are twice as wide";
    const render::Image image = viewer.picture();
    EXPECT_GT(colours_in(image, viewer.layout().left), 20U);
    EXPECT_GT(colours_in(image, viewer.layout().timeline), 20U);
    EXPECT_GT(colours_in(image, viewer.layout().plots), 20U);
  }
  close_and_expect_order(driven);
}

}  // namespace
}  // namespace palpate::app
