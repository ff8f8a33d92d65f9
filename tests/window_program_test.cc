// The program's windows on Xvfb, used by the X server's mouse and keyboard (xdotool).
#include <chrono>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "io/system/test/not_tested.h"
#include "palpate/error.h"
#include "palpate/recording.h"

#include "app/window/test/virtual_display.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using namespace std::chrono_literals;

bool installed(const std::string& program) {
  const char* path = getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

class WindowProgram : public testing::Test {
 protected:
  /// Whether Xvfb and xdotool are available. If not, prints the reason; the test must then return.
  [[nodiscard]] bool possible() const {
    if (!display_.there()) test::not_tested("there is no Xvfb (Debian package xvfb)");
    if (!installed("xdotool")) test::not_tested("there is no xdotool (Debian package xdotool)");
    return display_.there() && installed("xdotool");
  }
  /// OpenGL in software draws on one thread, so that it leaves a core of two to the loop.
  [[nodiscard]] std::map<std::string, std::string> on_display() const {
    return {{"DISPLAY", display_.name()},
            {"SDL_VIDEODRIVER", "x11"},
            {"LIBGL_ALWAYS_SOFTWARE", "1"},
            {"LP_NUM_THREADS", "1"}};
  }
  /// Uses mouse and keyboard by xdotool.
  void use(const std::string& what) const {
    const std::string command = "DISPLAY=" + display_.name() + " xdotool " + what;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;  // NOLINT(cert-env33-c)
  }
  /// Waits until the recording, which is being written, fulfils `done`. @return whether it did
  static bool wait_until(const std::string& file, const std::function<bool(const record::Recording&)>& done) {
    for (int i = 0; i < 300; ++i) {
      std::this_thread::sleep_for(200ms);
      try {
        if (done(record::read_recording(file))) return true;
      } catch (const InputError&) {  // not created yet
      }
    }
    return false;
  }
  /// Moves the mouse to the middle of the picture. The window is in the middle of the screen of 3840 x 2160.
  void mouse_to_picture() const { use("mousemove 1920 900 mousemove 1920 905"); }
  /// Turns the wheel away from the user: 5 mm to the organ, then 4 mm deep.
  void press_by_the_wheel() const {
    mouse_to_picture();
    use("click --repeat 9 --delay 20 4");
  }

  Folder folder_;
  app::VirtualDisplay display_;
};

double deepest(const record::Recording& recording) {
  double depth = 0.0;
  for (const haptics::TickRow& row : recording.rows) depth = std::max(depth, row.depth);
  return depth;
}

TEST_F(WindowProgram, IsPressedByTheMouseAndClosedAndTheRecordingReplays) {
  if (!possible()) return;
  Program program(folder_.path(),
                  {"run", "--organ", "ball", "--tissue", "liver", "--tool", "sphere:5", "--device", "mouse",
                   "--record", "a.h5"},
                  on_display());
  ASSERT_TRUE(wait_until(folder_ / "a.h5", [](const record::Recording& r) { return r.rows.size() > 100; }));
  press_by_the_wheel();
  EXPECT_TRUE(wait_until(folder_ / "a.h5", [](const record::Recording& r) { return deepest(r) > 2e-3; }));
  use("key Escape");
  std::this_thread::sleep_for(2s);
  EXPECT_FALSE(program.ended()) << "it asks while it records";
  for (int i = 0; i < 30 && !program.ended(); ++i) {
    use("key Left");  // from "Go on" to "End and leave"
    std::this_thread::sleep_for(500ms);
    use("key space");
    std::this_thread::sleep_for(500ms);
  }
  ASSERT_TRUE(program.ended());
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const record::Recording read = record::read_recording(folder_ / "a.h5");
  EXPECT_TRUE(read.facts.complete);
  EXPECT_NE(read.rows.back().phase, 0U) << "closed in mid-contact";
  EXPECT_EQ(run(folder_, {"replay", "a.h5", "--verify"}).exit_code, 0);
}

TEST_F(WindowProgram, ADisplayThatGoesInMidContactEndsTheRunInGoodOrder) {
  if (!possible()) return;
  // The mouse is not a held device: a machine that stands still for 20 ms is no fault of this run.
  Program program(folder_.path(),
                  {"run", "--organ", "ball", "--tissue", "liver", "--tool", "sphere:5", "--device", "mouse",
                   "--record", "a.h5"},
                  on_display());
  ASSERT_TRUE(wait_until(folder_ / "a.h5", [](const record::Recording& r) { return r.rows.size() > 100; }));
  press_by_the_wheel();
  ASSERT_TRUE(wait_until(folder_ / "a.h5", [](const record::Recording& r) {
    return !r.rows.empty() && r.rows.back().phase != 0 && r.rows.back().tissue_force > 0.01;
  }));
  display_.crash();
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("the display is gone"), std::string::npos) << outcome.err;
  const record::Recording read = record::read_recording(folder_ / "a.h5");
  EXPECT_TRUE(read.facts.complete) << "closed, its devices stopped before";
  EXPECT_EQ(run(folder_, {"replay", "a.h5", "--verify"}).exit_code, 0);
}

TEST_F(WindowProgram, TheViewerShowsWhatAScreenshotOfThatMomentShows) {
  if (!possible()) return;
  ASSERT_EQ(run(folder_, {"run", "--offline", "--duration-s", "2.5", "--record", "a.h5"}).exit_code, 0);
  Program program(folder_.path(), {"view", "a.h5", "--at-s", "2.1", "--map-mm", "10"}, on_display());
  const auto saved = [this]() -> std::optional<std::string> {
    for (const std::string& name : folder_.names())
      if (name.rfind("palpate-", 0) == 0) return name;
    return std::nullopt;
  };
  for (int i = 0; i < 60 && !saved(); ++i) {  // a key before the window opens is lost
    std::this_thread::sleep_for(1s);
    if (i == 0) mouse_to_picture();
    use("key ctrl+p");
  }
  for (int i = 0; i < 30; ++i) {
    std::this_thread::sleep_for(500ms);
    use("key Escape");
    if (program.ended()) break;
  }
  EXPECT_EQ(program.wait().exit_code, 0);
  ASSERT_TRUE(saved());
  const std::string picture = text_of(folder_ / *saved());
  const auto side = [&picture](std::size_t at) {  // of a PNG header, big-endian
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(picture.at(i));
    return std::to_string(value);
  };
  const Outcome drawn = run(folder_,
                            {"view", "a.h5", "--screenshot", "b.png", "--at-s", "2.1", "--map-mm", "10",
                             "--size", side(16) + "x" + side(20)},
                            {{"LIBGL_ALWAYS_SOFTWARE", "1"}});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(picture == text_of(folder_ / "b.png")) << "the same file, byte for byte";
}

TEST_F(WindowProgram, ABadScaleIsRefusedInOneLine) {
  const Outcome outcome = run(folder_, {"run", "--headless", "--duration-s", "0.1", "--ui-scale", "9"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find("--ui-scale 9"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace palpate::tests
