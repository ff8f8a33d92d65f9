// The window on Xvfb, driven by synthetic events.
#include "app/window/window.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/mesh.h"
#include "palpate/recording.h"
#include "palpate/scene.h"

#include "app/window/test/window_fixture.h"

namespace palpate::app {
namespace {

using ::testing::HasSubstr;

TEST_F(WindowTest, ShowsOrganPanelsAndPlotsSideBySide) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), full_scale());
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.5; }));
  driven.frames(2);
  const Layout& all = driven.window().layout();
  const render::Image image = driven.window().picture();
  EXPECT_EQ(image.width, 1000);
  EXPECT_EQ(image.height, 600);
  EXPECT_GT(colours_in(image, all.picture), 500U) << "organ and tool";
  EXPECT_GT(colours_in(image, all.left), 20U);
  EXPECT_GT(colours_in(image, all.right), 20U);
  EXPECT_GT(colours_in(image, all.bottom), 20U);
  EXPECT_EQ(all.left.x + all.left.width, all.picture.x) << "panels are beside the picture";
  EXPECT_EQ(all.picture.x + all.picture.width, all.right.x);
  driven.key(SDLK_F8);
  driven.frames(2);
  EXPECT_EQ(driven.window().layout().picture.width, 1000.0F) << "F8 puts the panels away";
  close_and_expect_order(driven);
}

TEST_F(WindowTest, DSpreadsADrapeUnderTheOrganAndTakesItAway) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), small());
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.1; }));
  const auto red_over_blue = [&] {  // in the lower left corner of the picture
    driven.frames(3);
    const Rectangle& place = driven.window().layout().picture;
    const render::Image image = driven.window().picture();
    const std::size_t pixel =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(place.y + 0.8F * place.height) +
        static_cast<std::size_t>(place.x + 0.05F * place.width);
    return static_cast<double>(image.rgb[3 * pixel]) / image.rgb[3 * pixel + 2];
  };
  const double without = red_over_blue();
  driven.key(SDLK_d);
  EXPECT_LT(red_over_blue(), 0.9 * without) << "a drape is bluer than the wall";
  driven.key(SDLK_d);
  EXPECT_NEAR(red_over_blue(), without, 0.02);
  close_and_expect_order(driven);
}

TEST_F(WindowTest, ARunBeginsOnceThePictureSuitsTheMachine) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), small());
  EXPECT_FALSE(driven.window().run().started());
  EXPECT_TRUE(driven.window().run().recording().empty());
  driven.frames(1);
  EXPECT_TRUE(driven.window().run().started());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  close_and_expect_order(driven);
}

TEST_F(WindowTest, ARunThatNeverBeganIsAccountedForWithZeroForce) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), small(file("never.h5")));
  const WindowOutcome outcome = driven.finish();
  EXPECT_TRUE(outcome.result.loop.stopped_early);
  EXPECT_EQ(outcome.result.loop.fault, haptics::Fault::kNone);
  EXPECT_EQ(outcome.frames, 0U);
  EXPECT_EQ(outcome.result.loop.ticks, 0U);
  EXPECT_FALSE(std::filesystem::exists(file("never.h5"))) << "a recording begins with its first tick";
}

TEST_F(WindowTest, AMousePressesAndTheRecordingReplaysToTheBit) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("mouse.h5");
  double depth = 0.0;
  {
    DrivenWindow driven(ball("mouse"), small(recording));
    driven.frames(3);
    driven.move_to_picture();
    for (int notch = 0; notch < 9; ++notch) Driven::wheel(1);  // 5 mm to the organ, then 4 mm deep
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].depth > 3e-3; }));
    depth = driven.window().snapshot().results[0].depth;
    EXPECT_EQ(driven.window().snapshot().results[0].phase, contact::Phase::kPress);
    EXPECT_GT(driven.window().snapshot().commands[0].force.z(), 0.01) << "it pushes up";
    close_and_expect_order(driven);  // during contact
    const WindowOutcome outcome = driven.finish();
    EXPECT_EQ(outcome.result.loop.fault, haptics::Fault::kNone);
    EXPECT_TRUE(outcome.result.loop.stopped_early);
    EXPECT_EQ(outcome.more_runs, 0U);
  }
  const record::Recording read = record::read_recording(recording);
  EXPECT_TRUE(read.facts.complete);
  EXPECT_GE(read.rows.back().tick, 100U);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
  EXPECT_NEAR(depth, 4e-3, 1e-3);
}

/// Runs frames until three new snapshots show the tool where it was. On a busy machine a frame can show the
/// last frame's snapshot.
bool until_tool_rests(DrivenWindow& driven) {
  Vec3 last = Vec3::Zero();
  std::uint64_t tick = 0;
  int unmoved = 0;
  return driven.until([&] {
    const haptics::Snapshot& now = driven.window().snapshot();
    if (now.tick == tick) return false;
    unmoved = (now.tools[0].pose_W.position - last).norm() < 1e-7 ? unmoved + 1 : 0;
    last = now.tools[0].pose_W.position;
    tick = now.tick;
    return unmoved == 3;
  });
}

TEST_F(WindowTest, TheToolIsUnderTheMouseStaysOnThePanelsAndWhileTheViewTurns) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), full_scale());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.frames(2);
  const auto tool = [&] { return driven.window().snapshot().tools[0].pose_W.position; };
  const Rectangle& place = driven.window().layout().picture;
  const int x = static_cast<int>(place.x + 0.5F * place.width);
  const int y = static_cast<int>(place.y + 0.5F * place.height);
  driven.move(x, y);
  driven.frames(20);
  ASSERT_TRUE(until_tool_rests(driven));
  EXPECT_NEAR(driven.window().snapshot().results[0].distance, 5e-3, 0.3e-3) << "it hovers";
  Vec3 before = tool();
  driven.move(x + 30, y);
  driven.frames(20);
  ASSERT_TRUE(until_tool_rests(driven));
  EXPECT_GT((tool() - before).norm(), 2e-3);
  EXPECT_NEAR(driven.window().snapshot().results[0].distance, 5e-3, 0.3e-3);
  before = tool();
  driven.move(static_cast<int>(place.x) / 2, y);  // on a panel
  driven.frames(10);
  EXPECT_LT((tool() - before).norm(), 1e-5);
  driven.move(x + 30, y);
  driven.frames(10);
  ASSERT_TRUE(until_tool_rests(driven));
  before = tool();
  const render::Image first = driven.window().picture();
  driven.button(SDL_BUTTON_RIGHT, true);
  driven.move(x - 60, y);
  driven.frames(10);
  EXPECT_NE(first.rgb, driven.window().picture().rgb);
  EXPECT_LT((tool() - before).norm(), 1e-5) << "the view turned instead";
  driven.button(SDL_BUTTON_RIGHT, false);
  driven.key(SDLK_f);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].distance > 25e-3; }));
  driven.key(SDLK_f);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].distance < 6e-3; }));
  close_and_expect_order(driven);
}

/// A search for a stone under the place above which the mouse starts.
scene::Overrides search_for_a_stone() {
  scene::Overrides request;
  request.scene_text = {
      "[scene]\ntask = \"palpate\"\n[organ]\nmesh = \"ball\"\ntissue = "
      "\"liver\"\n[[organ.inclusion]]\npreset = "
      "\"stone\"\nvisible = false\n[tool]\nmesh = \"sphere:5\"\n[device]\nkind = \"mouse\"\n",
      {}};
  return request;
}

// The stone lies under the tool's first place.
void move_above_stone(DrivenWindow& driven) {
  const auto place = driven.window().in_window(driven.window().snapshot().results[0].nearest_W);
  ASSERT_TRUE(place.has_value());
  driven.move(static_cast<int>(place->first), static_cast<int>(place->second));
}

TEST_F(WindowTest, ARunIsSavedAfterItsEndAndARecordingEndsWithItsRun) {
  if (!display_is_there()) return;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder());
  WindowOptions options = small();
  options.duration_s = 0.4;
  {
    DrivenWindow driven(ball("scripted"), options);
    ASSERT_TRUE(driven.until([&] { return driven.window().run().ended(); }));
    driven.key(SDLK_r, KMOD_LCTRL);
    ASSERT_TRUE(driven.until([&] { return !driven.window().recording(); }));
    const LiveRun<RowObserver>* first = &driven.window().run();
    driven.key(SDLK_RETURN);
    ASSERT_TRUE(driven.until([&] { return &driven.window().run() != first; }));
    ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.1; }));
    driven.key(SDLK_r, KMOD_LCTRL);
    driven.frames(1);
    close_and_expect_order(driven);
    (void)driven.finish();
  }
  std::filesystem::current_path(before);
  std::vector<std::size_t> rows;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    if (entry.path().extension() != ".h5") continue;
    const record::Recording read = record::read_recording(entry.path());
    EXPECT_TRUE(read.facts.complete) << entry.path();
    EXPECT_EQ(record::replay(read).rows_different, 0U) << entry.path();
    rows.push_back(read.rows.size());
  }
  ASSERT_EQ(rows.size(), 2U) << "names differ also within a second";
  EXPECT_EQ(std::max(rows[0], rows[1]), 400U) << "the whole first run";
}

TEST_F(WindowTest, AClickAttachesTheOrganWhereItIsChosenAndFurtherRunsKeepIt) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), small());
  driven.frames(5);
  driven.key(SDLK_h);
  driven.move_to_picture();
  driven.frames(5);
  driven.click();
  driven.frames(5);
  driven.key(SDLK_RETURN);  // once more
  ASSERT_TRUE(driven.until([&driven] {
    const Window& window = driven.window();
    return !window.preparing() && window.run().session().scene().support.has_value();
  }));
  const geometry::Support& support = *driven.window().run().session().scene().support;
  ASSERT_EQ(support.attachments.size(), 1U);
  EXPECT_DOUBLE_EQ(support.attachments[0].radius, 8e-3);  // on the surface of the ball of 30 mm
  EXPECT_NEAR(support.attachments[0].point.norm(), 0.03, 0.5e-3);
}

TEST_F(WindowTest, AMarkWithoutContactIsRefusedInWords) {
  if (!display_is_there()) return;
  DrivenWindow driven(search_for_a_stone(), small());
  const Window& window = driven.window();
  ASSERT_TRUE(driven.until([&] { return window.snapshot().hands == 1; }));
  driven.move_to_picture();
  driven.key(SDLK_m);
  ASSERT_TRUE(driven.until([&] { return !window.message().empty(); }));
  EXPECT_THAT(window.message(), HasSubstr("no mark: the tool does not touch the tissue"));
  EXPECT_EQ(window.search()->status().marks, 0U);
  close_and_expect_order(driven);
}

TEST_F(WindowTest, EachRecordedSearchEndsWithItsAnswerAndIsScoredInAFileOfItsOwn) {
  if (!display_is_there()) return;
  std::ofstream(file("search-2.h5")) << "in the way";
  WindowOptions options = small(file("search.h5"));
  options.stays = false;  // as with --record
  DrivenWindow driven(search_for_a_stone(), options);
  const Window& window = driven.window();
  ASSERT_TRUE(driven.until([&] { return window.snapshot().hands == 1; }));
  move_above_stone(driven);
  for (int notch = 0; notch < 20; ++notch) Driven::wheel(1);
  ASSERT_TRUE(driven.until([&] { return window.snapshot().results[0].depth > 4e-3; }));
  driven.key(SDLK_m);
  ASSERT_TRUE(driven.until([&] { return window.search()->status().marks == 1; }));
  ASSERT_TRUE(driven.press({"left", "End the search"}));
  ASSERT_TRUE(driven.until([&] { return window.search()->ended(); }));
  driven.frames(5);
  EXPECT_TRUE(driven.alive()) << "the answer stays in the window";
  EXPECT_THAT(window.banner(), HasSubstr("1 of 1 lump found"));
  EXPECT_EQ(window.snapshot().hands, 0U) << "no tool hides the last mark";
  const LiveRun<RowObserver>* first = &window.run();
  ASSERT_TRUE(driven.press({"left", "Run again"}));
  ASSERT_TRUE(driven.until([&] { return &window.run() != first && window.snapshot().hands == 1; }));
  EXPECT_EQ(window.run().recording(), file("search-3.h5"));
  ASSERT_TRUE(driven.press({"left", "End the search"}));
  ASSERT_TRUE(driven.until([&] { return window.search()->ended(); }));
  close_and_expect_order(driven);
  const WindowOutcome outcome = driven.finish();
  ASSERT_EQ(outcome.searches.size(), 2U);
  EXPECT_EQ(outcome.searches[0].recording, file("search.h5"));
  EXPECT_EQ(std::get<palpation::Score>(outcome.searches[0].score).found, 1U);
  EXPECT_EQ(outcome.searches[1].recording, file("search-3.h5"));
  EXPECT_EQ(std::get<palpation::Score>(outcome.searches[1].score).found, 0U);
  EXPECT_EQ(std::filesystem::file_size(file("search-2.h5")), 10U) << "no file is overwritten";
  for (const SearchOutcome& search : outcome.searches) {
    EXPECT_EQ(record::replay(record::read_recording(search.recording)).rows_different, 0U);
  }
}

TEST_F(WindowTest, ASearchMarksPlacesSlowsTheMouseOverAStoneAndEndsWithAScore) {
  if (!display_is_there()) return;
  DrivenWindow driven(search_for_a_stone(), small());
  const Window& window = driven.window();
  driven.frames(3);
  ASSERT_NE(window.search(), nullptr);
  EXPECT_EQ(window.search()->pointer_gain(window.traces()), 1.0);
  ASSERT_TRUE(driven.until([&] { return window.snapshot().hands == 1; }));
  move_above_stone(driven);
  for (int notch = 0; notch < 20; ++notch) Driven::wheel(1);
  ASSERT_TRUE(driven.until([&] { return window.snapshot().results[0].depth > 4e-3; }));
  ASSERT_TRUE(driven.until([&] { return window.search()->pointer_gain(window.traces()) < 0.95; }));
  driven.key(SDLK_m);
  ASSERT_TRUE(driven.until([&] { return window.search()->status().marks == 1; }));
  driven.frames(8);  // until the key's button is released
  driven.click();
  ASSERT_TRUE(driven.until([&] { return window.search()->status().marks == 2; }));
  EXPECT_FALSE(window.search()->ended());
  ASSERT_TRUE(driven.press({"left", "End the search"}));
  ASSERT_TRUE(driven.until([&] { return window.search()->ended(); }));
  const palpation::Score& score = *window.search()->score();
  EXPECT_EQ(score.found, 1U);
  EXPECT_EQ(score.repeated, 1U);
  EXPECT_GT(score.coverage, 0.0);
  EXPECT_GT(score.largest_force, 0.1);
  close_and_expect_order(driven);
}

TEST_F(WindowTest, TheWheelInsertsANeedleAndTheEndShowsWhatWasHiddenAndTheScore) {
  if (!display_is_there()) return;
  scene::Overrides request;
  request.scene_text = {
      "[scene]\ntask = \"insert\"\n[organ]\nmesh = \"box\"\n[search]\ndepth_mm = 17\n[tool]\nmesh = "
      "\"needle\"\n",
      {}};
  request.device = "mouse";
  DrivenWindow driven(request, small());
  const Window& window = driven.window();
  ASSERT_TRUE(driven.until([&] { return window.snapshot().hands == 1; }));
  const auto place = window.in_window(window.snapshot().results[0].nearest_W);
  ASSERT_TRUE(place.has_value());
  driven.move(static_cast<int>(place->first), static_cast<int>(place->second));
  ASSERT_TRUE(driven.until([&] {
    Driven::wheel(1);
    return window.snapshot().results[0].needle.layer == 3;
  }));
  EXPECT_EQ(window.snapshot().results[0].phase, contact::Phase::kInsert);
  ASSERT_TRUE(until_tool_rests(driven));
  ASSERT_TRUE(driven.point_at({"left", "End the insertion"}));
  driven.window().hold_full_quality();
  driven.frames(2);
  const std::vector<std::uint8_t> before = cut_out(window.picture(), window.layout().picture);
  driven.click();
  ASSERT_TRUE(driven.until([&] { return window.run().ended(); }));
  driven.window().hold_full_quality();
  driven.frames(2);
  const std::vector<std::uint8_t> after = cut_out(window.picture(), window.layout().picture);
  ASSERT_EQ(after.size(), before.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < after.size(); ++i) different += std::abs(after[i] - before[i]) > 10 ? 1 : 0;
  EXPECT_GT(different, 3 * 200U) << "the target in the tissue, which was not drawn before";
  ASSERT_TRUE(driven.alive());
  close_and_expect_order(driven);
  const WindowOutcome outcome = driven.finish();
  ASSERT_EQ(outcome.searches.size(), 1U);
  const auto& score = std::get<palpation::InsertionScore>(outcome.searches[0].score);
  EXPECT_EQ(score.attempts, 1U);
  EXPECT_THAT(score.crossed, testing::ElementsAre("skin", "fat", "muscle"));
}

TEST_F(WindowTest, AMouseGraspsAndPulls) {
  if (!display_is_there()) return;
  scene::Overrides request;
  request.task = "pull";
  request.device = "mouse";
  DrivenWindow driven(request, small());
  driven.frames(3);
  driven.move_to_picture();
  for (int notch = 0; notch < 5; ++notch) Driven::wheel(1);
  driven.frames(20);
  ASSERT_TRUE(until_tool_rests(driven));
  EXPECT_LT(driven.window().snapshot().results[0].distance, 0.9e-3);
  driven.button(SDL_BUTTON_LEFT, true);
  ASSERT_TRUE(
      driven.until([&] { return driven.window().snapshot().results[0].phase == contact::Phase::kPull; }));
  for (int notch = 0; notch < 6; ++notch) Driven::wheel(-1);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].depth > 4e-3; }));
  EXPECT_LT(driven.window().snapshot().commands[0].force.z(), -0.01) << "the tissue pulls back";
  driven.button(SDL_BUTTON_LEFT, false);
  ASSERT_TRUE(
      driven.until([&] { return driven.window().snapshot().results[0].phase != contact::Phase::kPull; }));
  close_and_expect_order(driven);
}

TEST_F(WindowTest, AFaultStandsAcrossThePictureInWordsUntilItIsReset) {
  if (!display_is_there()) return;
  std::optional<DrivenWindow> shown;
  ASSERT_NO_FATAL_FAILURE(show_failure(shown, failing(file("lost.toml"), "freeze", "0.3", "0.2"), small()));
  DrivenWindow& driven = *shown;
  EXPECT_THAT(driven.window().banner(), HasSubstr("Zero force"));
  EXPECT_THAT(driven.window().banner(), HasSubstr("the device gave no new sample for 5 ms"));
  EXPECT_THAT(driven.window().banner(), HasSubstr("R resets"));
  driven.frames(1);
  Rectangle top = driven.window().layout().picture;
  top.height = 24.0F;
  EXPECT_GT(red_share(driven.window().picture(), top), 0.5);
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.6; }));
  driven.key(SDLK_r);
  EXPECT_TRUE(driven.until([&] { return driven.window().banner().empty(); })) << driven.window().banner();
  close_and_expect_order(driven);
  EXPECT_EQ(driven.finish().result.loop.fault, haptics::Fault::kStale) << "the account keeps it";
}

TEST_F(WindowTest, AGamepadPressesAndItsLossIsAFault) {
  if (!display_is_there()) return;
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  ASSERT_EQ(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER), 0);
  const int pad = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                            SDL_CONTROLLER_BUTTON_MAX, 0);
  ASSERT_GE(pad, 0) << SDL_GetError();
  SDL_Joystick* joystick = SDL_JoystickOpen(pad);
  const auto trigger = [joystick](Sint16 value) {
    SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_TRIGGERRIGHT, value);
  };
  trigger(-32768);
  {
    DrivenWindow driven(ball("gamepad"), small());
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
    driven.frames(3);
    ASSERT_EQ(driven.window().banner(), "");
    trigger(32767);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].depth > 5e-3; }));
    SDL_JoystickDetachVirtual(pad);
    ASSERT_TRUE(driven.until([&] { return !driven.window().banner().empty(); }));
    EXPECT_THAT(driven.window().banner(), HasSubstr("no gamepad is connected"));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().commands[0].force.norm() == 0.0; }));
    close_and_expect_order(driven);
    EXPECT_EQ(driven.finish().result.loop.fault, haptics::Fault::kDevice);
  }
  SDL_JoystickClose(joystick);
  SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}

TEST_F(WindowTest, TissueAndNoiseChangeWhileTheyAreFelt) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("changed.h5");
  {
    DrivenWindow driven(ball("mouse"), small(recording));
    driven.frames(3);
    driven.move_to_picture();
    for (int notch = 0; notch < 14; ++notch) Driven::wheel(1);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().results[0].depth > 3.5e-3; }));
    driven.key(SDLK_n);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change == 1; }));
    const std::uint64_t noise_off = driven.window().snapshot().tick;
    const std::filesystem::path tissue = file("stiff.toml");
    model::TissueParameters stiff = model::tissue_preset("liver");
    stiff.name = "stiff";
    stiff.k1 *= 3.0;
    std::ofstream(tissue) << scene::to_toml(stiff);
    const double before = driven.window().traces().newest(0).tissue_force;
    Driven::drop(tissue.string());
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change == 2; }));
    ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest(0).tissue_force > 2.0 * before; }));
    // The noise fades out within 50 ms. The traces lag the snapshot by one frame.
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().tick > noise_off + 200; }));
    EXPECT_EQ(driven.window().traces().newest(0).noise_force, 0.0);
    close_and_expect_order(driven);
    (void)driven.finish();
  }
  EXPECT_EQ(record::replay(record::read_recording(recording)).rows_different, 0U);
}

TEST_F(WindowTest, ADroppedMeshIsAskedForItsUnitAndThenTouched) {
  if (!display_is_there()) return;
  const std::filesystem::path mesh = file("block.obj");
  {
    std::ofstream out(mesh);
    const geometry::TriangleMesh box = geometry::make_box(Vec3(60.0, 60.0, 30.0), 15.0);
    for (const Vec3& v : box.vertices) out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
    for (const geometry::Triangle& t : box.triangles)
      out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  DrivenWindow driven(ball("scripted"), small());
  driven.frames(3);
  Driven::drop(mesh.string());
  driven.frames(3);
  EXPECT_TRUE(driven.window().panels().files.is_open());
  EXPECT_FALSE(driven.window().preparing()) << "a unit is never guessed";
  driven.window().panels().files.choose_unit("mm");
  driven.key(SDLK_RETURN);
  ASSERT_TRUE(
      driven.until([&] { return driven.window().run().session().scene().organ_name == mesh.string(); }));
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.2; }));
  Driven::drop(file("holiday.jpg").string());
  driven.frames(2);
  EXPECT_THAT(driven.window().message(), HasSubstr("holiday.jpg: palpate reads meshes"));
  std::ofstream(file("bad.toml")) << "[organ]\nmesh = 3\n";
  Driven::drop(file("bad.toml").string());
  ASSERT_TRUE(driven.until([&] { return driven.window().message().find("bad.toml") != std::string::npos; }));
  EXPECT_FALSE(driven.window().run().ended()) << "what is touched goes on";
  close_and_expect_order(driven);
  EXPECT_EQ(driven.finish().more_runs, 1U);
}

TEST_F(WindowTest, LivesThroughAnySize) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), small());
  driven.frames(3);
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(3840, 2160), std::pair(300, 900), std::pair(1000, 600)}) {
    const int wide = width;  // clang 14: a lambda cannot capture a structured binding
    Driven::resize(width, height);
    ASSERT_TRUE(driven.until([&] { return driven.window().picture().width == wide; })) << wide;
    driven.frames(2);
    EXPECT_EQ(driven.window().picture().height, height);
    EXPECT_TRUE(driven.alive());
  }
  close_and_expect_order(driven);
}

TEST_F(WindowTest, RunsAgainAndHoldsThePicture) {
  if (!display_is_there()) return;
  WindowOptions options = small();
  options.duration_s = 0.4;
  DrivenWindow driven(ball("scripted"), options);
  ASSERT_TRUE(driven.until([&] { return driven.window().run().ended(); }));
  driven.frames(2);
  EXPECT_THAT(driven.window().banner(), HasSubstr("The run has ended"));
  const LiveRun<RowObserver>* first = &driven.window().run();
  driven.key(SDLK_RETURN);
  ASSERT_TRUE(driven.until([&] { return &driven.window().run() != first && !driven.window().preparing(); }));
  driven.key(SDLK_SPACE);
  driven.frames(3);
  const std::uint64_t held = driven.window().snapshot().tick;
  driven.frames(3);
  EXPECT_EQ(driven.window().snapshot().tick, held);
  driven.key(SDLK_F1);
  driven.frames(2);
  EXPECT_TRUE(driven.window().panels().help);
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_TRUE(driven.alive()) << "the first Esc closes the keys";
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_TRUE(driven.alive()) << "a second tap at once is for the keys, too";
  SDL_Delay(EscapeGuard::kQuiet);
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_FALSE(driven.alive());
  EXPECT_EQ(driven.finish().more_runs, 1U);
}

TEST_F(WindowTest, WithoutADisplayThereIsNoneAndTheReasonIsSaid) {
  setenv("DISPLAY", ":77777", 1);
  unsetenv("WAYLAND_DISPLAY");
  setenv("SDL_VIDEODRIVER", "x11", 1);
  try {
    const Display none("test", {100, 100});
    ADD_FAILURE() << "there is a window on no display";
  } catch (const NoWindow& error) {
    EXPECT_THAT(error.what(), HasSubstr("no window can be opened"));
  }
  unsetenv("DISPLAY");
  EXPECT_FALSE(display_there());
}

}  // namespace
}  // namespace palpate::app
