// Mouse clicks and typing in the panels of a run's window.
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/recording.h"
#include "palpate/scene.h"

#include "app/window/test/window_fixture.h"

namespace palpate::app {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kFirstHand("\0\0\0\0", 4);  // ImGui's identity of hand 0

class PanelsTest : public WindowTest {
 protected:
  PanelsTest() { std::filesystem::current_path(folder()); }
  ~PanelsTest() override { std::filesystem::current_path(before_); }

  static WindowOptions tall(std::filesystem::path recording = {}) {
    WindowOptions options = small(std::move(recording));
    options.size = {550, 450};
    return options;
  }
  /// Waits for a file with this extension to appear. @return the first one, or an empty path
  std::filesystem::path wait_for_file(DrivenWindow& driven, const std::string& ending) {
    std::filesystem::path found;
    driven.until([&] {
      for (const auto& entry : std::filesystem::directory_iterator(folder())) {
        if (entry.path().extension() == ending) found = entry.path();
      }
      return !found.empty();
    });
    return found;
  }

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

TEST_F(PanelsTest, SliderPresetAndNoiseBoxChangeWhatIsFeltAndTheRecordingKnows) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("changed.h5");
  {
    DrivenWindow driven(ball("mouse"), tall(recording));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
    ASSERT_TRUE(driven.point_at({"left", "numbers", "##Stiffness k\u2081"}));
    const auto [x, y] = driven.window().mouse_at();
    driven.button(SDL_BUTTON_LEFT, true);
    driven.frames(2);
    driven.move(x + 40, y);
    driven.frames(2);
    driven.button(SDL_BUTTON_LEFT, false);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change >= 1; }));
    ASSERT_TRUE(driven.press({"left", "preset", "##preset"}));
    driven.frames(20);  // the slider's last change is applied by now
    const std::uint64_t before_heart = driven.window().snapshot().change;
    ASSERT_TRUE(driven.press({"##Combo_00", "heart"}));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change > before_heart; }));
    ASSERT_TRUE(driven.press({"left", "On  (N)"}));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change > before_heart + 1; }));
    close_and_expect_order(driven);
    (void)driven.finish();
  }
  const record::Recording read = record::read_recording(recording);
  ASSERT_GE(read.changes.size(), 3U);
  const double preset = model::tissue_preset("liver").k1;
  EXPECT_GT(read.changes.front().tissue.k1, preset + 1.0) << "40 units to the right at 0.1 N/m a unit";
  EXPECT_STREQ(read.changes[read.changes.size() - 2].name.data(), "heart");
  EXPECT_FALSE(read.changes.back().noise.enabled);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
}

TEST_F(PanelsTest, AVisibleInclusionHasASliderThatChangesWhatIsFeltAndAHiddenOneHasNone) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("inclusion.h5");
  const std::filesystem::path lumps = file("lumps.toml");
  std::ofstream(lumps) << "[organ]\nmesh = \"ball\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n"
                          "[device]\nkind = \"mouse\"\n"
                          "[[organ.inclusion]]\npreset = \"cyst\"\nvisible = false\n"
                          "[[organ.inclusion]]\npreset = \"nodule\"\n";
  {
    scene::Overrides request;
    request.scene = lumps;
    DrivenWindow driven(request, tall(recording));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
    const std::string_view second("\1\0\0\0", 4);  // ImGui's identity of inclusion 1
    ASSERT_TRUE(driven.point_at({"left", "inclusions", second, "##nodule"}));
    const auto [x, y] = driven.window().mouse_at();
    driven.button(SDL_BUTTON_LEFT, true);
    driven.frames(2);
    driven.move(x + 40, y);
    driven.frames(2);
    driven.button(SDL_BUTTON_LEFT, false);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change >= 1; }));
    driven.frames(5);
    EXPECT_FALSE(driven.point_at({"left", "inclusions", kFirstHand, "##cyst"}));
    (void)driven.finish();
  }
  const record::Recording read = record::read_recording(recording);
  ASSERT_GE(read.changes.size(), 1U);
  EXPECT_EQ(read.changes.back().inclusion.index, 1U);
  EXPECT_GT(read.changes.back().inclusion.ratio, read.scene.inclusions[1].inclusion.ratio);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
}

TEST_F(PanelsTest, ARelaxationTermIsAddedAndShown) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  ASSERT_TRUE(driven.press({"left", "Relaxation"}));
  driven.frames(5);
  ASSERT_TRUE(driven.press({"left", "Relaxation", "One more term"}));
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change >= 1; }));
  const std::string_view first("\0\0\0\0", 4);  // ImGui's identity of term 0
  EXPECT_TRUE(driven.point_at({"left", "Relaxation", first, "term", "##Share"}));
  (void)driven.finish();
}

TEST_F(PanelsTest, ANumberIsTypedAndTheTissueSavedByItsDialogOrTheReasonShown) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  ASSERT_TRUE(driven.point_at({"left", "numbers", "##Stiffness k\u2081"}));
  driven.click_with(KMOD_CTRL);  // opens the field, like a double click of any speed
  driven.key(SDLK_a, KMOD_CTRL);
  driven.type("77.5");
  driven.key(SDLK_RETURN);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().change >= 1; }));
  const auto save_as = [&driven](const char* name) {
    ASSERT_TRUE(driven.press({"left", "Save as a file ..."}));
    ASSERT_TRUE(driven.window().panels().files.is_open());
    driven.frames(2);
    driven.key(SDLK_a, KMOD_CTRL);
    driven.type(name);
    ASSERT_TRUE(driven.press({"Choose a file", "Save"}));
    EXPECT_FALSE(driven.window().panels().files.is_open());
  };
  save_as("mine.toml");
  EXPECT_THAT(driven.window().message(), HasSubstr("mine.toml"));
  EXPECT_EQ(scene::read_tissue_file(file("mine.toml")).k1, 77.5);
  save_as("/dev/full");
  EXPECT_EQ(driven.window().message(), "/dev/full: cannot be written: No space left on device");
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, RecordsTakesAPictureRunsAgainAndOpensTheViewer) {
  if (!display_is_there()) return;
  WindowOptions options = tall();
  options.viewer = file("viewer.sh");
  std::ofstream(options.viewer) << "#!/bin/sh\necho \"$@\" > " << file("looked").string() << "\n";
  std::filesystem::permissions(options.viewer, std::filesystem::perms::owner_all);
  DrivenWindow driven(ball("mouse"), options);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.key(SDLK_v);
  driven.frames(1);
  EXPECT_THAT(driven.window().message(), HasSubstr("nothing is recorded yet"));
  const LiveRun<RowObserver>* only = &driven.window().run();
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.2; }));
  ASSERT_TRUE(driven.press({"left", "###record"}));
  const std::filesystem::path recording = wait_for_file(driven, ".h5");
  ASSERT_FALSE(recording.empty());
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.3; }));
  ASSERT_TRUE(driven.press({"left", "Look at it"}));
  ASSERT_TRUE(driven.until([&] { return std::filesystem::exists(file("looked")); }))
      << driven.window().message();
  ASSERT_TRUE(driven.press({"left", "###record"}));
  driven.frames(2);
  EXPECT_EQ(&driven.window().run(), only) << "the run goes on at both ends of a recording";
  const record::Recording read = record::read_recording(recording);
  EXPECT_TRUE(read.facts.complete);
  EXPECT_EQ(read.rows.front().tick, 0U);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
  ASSERT_TRUE(driven.press({"left", "Picture"}));
  EXPECT_FALSE(wait_for_file(driven, ".png").empty());
  const LiveRun<RowObserver>* before = &driven.window().run();
  ASSERT_TRUE(driven.press({"left", "Run again"}));
  ASSERT_TRUE(driven.until([&] { return &driven.window().run() != before && !driven.window().preparing(); }));
  std::string words;
  ASSERT_TRUE(driven.until([&] {
    std::getline(std::ifstream(file("looked")), words);
    return !words.empty();
  }));
  EXPECT_EQ(words, "view " + recording.string());
  close_and_expect_order(driven);
  EXPECT_EQ(driven.finish().more_runs, 1U);
}

TEST_F(PanelsTest, EscAsksWhileItRecordsAndAgainGoesOn) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall(file("asked.h5")));
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_TRUE(driven.alive());
  EXPECT_EQ(driven.window().panels().leave, LeaveDialog::kOpen);
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_TRUE(driven.alive());
  EXPECT_EQ(driven.window().panels().leave, LeaveDialog::kClosed);
  EXPECT_FALSE(driven.window().run().ended()) << "the run went on";
  SDL_Delay(EscapeGuard::kQuiet);
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  ASSERT_TRUE(driven.press({"Leave?", "End and leave"}));
  EXPECT_FALSE(driven.alive());
  (void)driven.finish();
  EXPECT_TRUE(record::read_recording(file("asked.h5")).facts.complete);
}

TEST_F(PanelsTest, EscLeavesAtOnceWithoutARecording) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.key(SDLK_ESCAPE);
  driven.frames(1);
  EXPECT_FALSE(driven.alive());
}

TEST_F(PanelsTest, ParametersAreUndoneRedoneAndReset) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("undone.h5");
  {
    DrivenWindow driven(ball("mouse"), tall(recording));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
    const auto changes = [&](std::uint64_t count) {
      return driven.until([&] { return driven.window().snapshot().change >= count; });
    };
    ASSERT_TRUE(driven.point_at({"left", "numbers", "##Stiffness k\u2081"}));
    const auto [x, y] = driven.window().mouse_at();
    driven.button(SDL_BUTTON_LEFT, true);
    for (int i = 0; i < 4; ++i) {
      driven.frames(2);
      driven.move(x + 10 * i, y);
    }
    driven.button(SDL_BUTTON_LEFT, false);
    driven.frames(3);
    ASSERT_TRUE(changes(1));
    driven.key(SDLK_n);
    driven.key(SDLK_z, KMOD_LCTRL);  // the noise
    driven.key(SDLK_z, KMOD_LCTRL);  // the drag, in one step
    driven.key(SDLK_z, KMOD_LCTRL);
    driven.frames(1);
    EXPECT_THAT(driven.window().message(), HasSubstr("no change of this run is left to undo"));
    driven.key(SDLK_y, KMOD_LCTRL);  // the drag again
    driven.frames(2);
    ASSERT_TRUE(driven.press({"left", "Reset to preset"}));
    driven.frames(5);
    close_and_expect_order(driven);
    (void)driven.finish();
  }
  const record::Recording read = record::read_recording(recording);
  const double preset = model::tissue_preset("liver").k1;
  ASSERT_GE(read.changes.size(), 4U);
  const std::size_t last = read.changes.size() - 1;
  EXPECT_EQ(read.changes[last].tissue.k1, preset) << "reset";
  EXPECT_GT(read.changes[last - 1].tissue.k1, preset) << "redone";
  EXPECT_EQ(read.changes[last - 2].tissue.k1, preset) << "undone";
  EXPECT_TRUE(read.changes[last].noise.enabled);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
}

TEST_F(PanelsTest, ASceneOfTheGalleryIsTakenOverByTheMouse) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("scripted"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  ASSERT_TRUE(driven.press({"left", "scene", "###scene"}));
  driven.frames(2);
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_FALSE(driven.window().panels().gallery.is_open()) << "Esc closes the gallery";
  EXPECT_TRUE(driven.alive());
  ASSERT_TRUE(driven.press({"left", "scene", "###scene"}));
  driven.frames(2);
  EXPECT_GT(colours_in(driven.window().picture(), driven.window().layout().picture), 2000U) << "pictures";
  ASSERT_TRUE(driven.press({"Scenes", "##gallstone"}));
  const auto scene = [&]() -> const scene::Scene& { return driven.window().run().session().scene(); };
  ASSERT_TRUE(driven.until([&] { return scene().name == "stone in a gallbladder"; }));
  EXPECT_EQ(scene().devices.front().kind, "mouse");
  EXPECT_THAT(driven.window().message(), HasSubstr("organ gallbladder (before: ball)"));
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, AnotherTaskKeepsToolTissueAndNoise) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.key(SDLK_n);
  ASSERT_TRUE(driven.press({"left", "scene", "pull"}));
  const auto scene = [&]() -> const scene::Scene& { return driven.window().run().session().scene(); };
  ASSERT_TRUE(driven.until([&] { return scene().task == scene::Task::kPull; })) << driven.window().message();
  EXPECT_EQ(scene().organ_name, "ball");
  EXPECT_EQ(scene().tissue.name, "liver");
  EXPECT_FALSE(scene().noise.enabled);
  EXPECT_THAT(driven.window().message(), HasSubstr("tool straight-forceps (before: sphere:5)"));
  EXPECT_THAT(driven.window().message(), ::testing::Not(HasSubstr("tissue")));
  ASSERT_TRUE(driven.press({"left", "scene", "press"}));
  ASSERT_TRUE(driven.until([&] { return scene().task == scene::Task::kPress; }));
  EXPECT_EQ(scene().tools.front().name, "straight-forceps") << "they fit a press";
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, EnterAfterAPanelDoesNotRunAgain) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("mouse"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  const LiveRun<RowObserver>* first = &driven.window().run();
  ASSERT_TRUE(driven.press({"left", "numbers", "##Stiffness k\u2081"}));
  driven.key(SDLK_RETURN);
  driven.frames(2);
  EXPECT_FALSE(driven.window().preparing());
  EXPECT_THAT(driven.window().message(), HasSubstr("Enter runs again after a click on the picture"));
  driven.move_to_picture();
  driven.frames(2);
  driven.click();
  driven.key(SDLK_RETURN);
  ASSERT_TRUE(driven.until([&] { return &driven.window().run() != first && !driven.window().preparing(); }));
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, FilesAreChosenByMouseAndByKeyboard) {
  if (!display_is_there()) return;
  std::ofstream(file("other.toml"))
      << "[organ]\nmesh = \"ball\"\ntissue = \"kidney\"\n[tool]\nmesh = \"sphere:3\"\n";
  DrivenWindow driven(ball("scripted"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  ASSERT_TRUE(driven.press({"left", "scene", "###scene"}));
  driven.frames(2);
  ASSERT_TRUE(driven.press({"Scenes", "Browse for a file ..."}));
  driven.frames(2);
  const ImGuiWindow* dialog = ImGui::FindWindowByName("Choose a file");
  ASSERT_NE(dialog, nullptr);
  std::array<char, 64> entries{};
  std::snprintf(entries.data(), entries.size(), "Choose a file/entries_%08X",
                ImHashStr("entries", 0, ImHashStr("Choose a file")));
  ASSERT_TRUE(driven.press({entries.data(), "other.toml"}));
  ASSERT_TRUE(driven.press({"Choose a file", "Open"}));
  const auto tissue = [&] { return driven.window().run().session().scene().tissue.name; };
  ASSERT_TRUE(driven.until([&] { return tissue() == "kidney"; })) << driven.window().message();
  driven.key(SDLK_o, KMOD_CTRL);
  driven.frames(2);
  driven.type("nothing.stl");
  driven.key(SDLK_RETURN);
  EXPECT_TRUE(driven.window().panels().files.is_open()) << "no such file, and no unit";
  driven.key(SDLK_ESCAPE);
  driven.frames(2);
  EXPECT_FALSE(driven.window().panels().files.is_open());
  EXPECT_TRUE(driven.alive());
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, ALostDeviceIsSaidInWordsAndResetByAClick) {
  if (!display_is_there()) return;
  std::optional<DrivenWindow> shown;
  ASSERT_NO_FATAL_FAILURE(show_failure(shown, failing(file("lost.toml"), "drop-out", "0.3", "0.4"), tall()));
  DrivenWindow& driven = *shown;
  EXPECT_THAT(driven.window().banner(), HasSubstr("Zero force: the device"));
  EXPECT_EQ(driven.window().snapshot().commands[0].gripper_force, 0.0);
  ASSERT_TRUE(driven.until([&] { return driven.window().traces().newest_time() > 0.8; }));
  EXPECT_EQ(device_force(driven.window().traces().newest(0)), 0.0) << "latched";
  // The rows above the button change with the hand's state, so that it moves: click until it was hit.
  for (int attempt = 0; attempt < 5 && !driven.window().banner().empty(); ++attempt) {
    (void)driven.press({"right", kFirstHand, "Reset the fault  (R)"});
    driven.frames(10);
  }
  EXPECT_EQ(driven.window().banner(), "");
  close_and_expect_order(driven);
  EXPECT_EQ(driven.finish().result.loop.fault, haptics::Fault::kDevice) << "the account keeps it";
}

TEST_F(PanelsTest, ARunIsPausedWhereNoHandHoldsTheDevice) {
  if (!display_is_there()) return;
  const std::filesystem::path recording = file("paused.h5");
  {
    DrivenWindow driven(ball("mouse"), tall(recording));
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
    ASSERT_TRUE(driven.press({"left", "###pause"}));
    ASSERT_TRUE(driven.until([&] { return driven.window().run().pausing(); }));
    EXPECT_THAT(driven.window().banner(), HasSubstr("The run is paused"));
    std::uint64_t stands = 0;
    ASSERT_TRUE(driven.until([&] {
      const std::uint64_t before = std::exchange(stands, driven.window().snapshot().tick);
      return before == stands;
    }));
    driven.frames(5);
    EXPECT_EQ(driven.window().snapshot().tick, stands);
    for (int i = 0; i < 12; ++i) driven.key(SDLK_n);  // more than a loop's queue can hold
    driven.key(SDLK_SPACE, KMOD_CTRL);
    ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().tick > stands + 20; }));
    EXPECT_EQ(driven.window().snapshot().change, 1U) << "the newest of what was changed meanwhile";
    close_and_expect_order(driven);
    EXPECT_EQ(driven.finish().result.loop.pauses, 1U);
  }
  EXPECT_EQ(record::replay(record::read_recording(recording)).rows_different, 0U);
}

TEST_F(PanelsTest, ARunOfAHeldDeviceIsNotPaused) {
  if (!display_is_there()) return;
  DrivenWindow driven(ball("emulated"), tall());
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  driven.key(SDLK_SPACE, KMOD_CTRL);
  driven.frames(2);
  EXPECT_FALSE(driven.window().run().pausing());
  EXPECT_THAT(driven.window().message(), HasSubstr("a hand holds the device"));
  const std::uint64_t tick = driven.window().snapshot().tick;
  EXPECT_TRUE(driven.until([&] { return driven.window().snapshot().tick > tick; }));
  close_and_expect_order(driven);
}

TEST_F(PanelsTest, HoldAtTwiceTheScale) {
  if (!display_is_there()) return;
  WindowOptions options = tall();
  options.size = {2200, 1800};
  options.scale = 2.0F;
  DrivenWindow driven(ball("scripted"), options);
  ASSERT_TRUE(driven.until([&] { return driven.window().snapshot().hands == 1; }));
  const Layout& all = driven.window().layout();
  EXPECT_EQ(all.left.width, 636.0F);
  EXPECT_EQ(all.right.width, 636.0F);
  EXPECT_EQ(ImGui::GetFontSize(), 30.0F);
  for (const char* name : {"left", "right"}) {
    const ImGuiWindow* column = ImGui::FindWindowByName(name);
    ASSERT_NE(column, nullptr);
    EXPECT_EQ(column->ScrollMax.x, 0.0F) << "nothing is cut off at the side of " << name;
  }
  EXPECT_TRUE(driven.press({"left", "Run again"})) << "the mouse is where things are";
  close_and_expect_order(driven);
}

}  // namespace
}  // namespace palpate::app
