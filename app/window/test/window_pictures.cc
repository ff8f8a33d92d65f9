// Pictures of the window for docs/pictures, on a display of their own: palpate_window_pictures FOLDER
#include <atomic>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include "palpate/offscreen.h"

#include "app/window/test/driven_window.h"
#include "app/window/test/virtual_display.h"

namespace {

using palpate::app::Driven;
using palpate::app::DrivenWindow;

constexpr double kSlow = 240.0;  // s: this machine may have no graphics card

/// Turns the wheel notch by notch, as a hand would.
void wheel(DrivenWindow& driven, int notches) {
  const int one = notches > 0 ? 1 : -1;
  for (int i = 0; i != notches; i += one) {
    Driven::wheel(one);
    const double from = driven.window().traces().newest_time();
    driven.until([&] { return driven.window().traces().newest_time() > from + 0.08; }, kSlow);
  }
}

/// A mouse presses or pulls, and holds; all panels are there.
void experiment(const std::filesystem::path& file, const char* task) {
  palpate::scene::Overrides request;
  request.task = task;
  request.device = "mouse";
  DrivenWindow driven(request);
  driven.frames(3);
  driven.move_to_picture();
  if (std::string(task) == "pull") {
    wheel(driven, 10);
    driven.button(SDL_BUTTON_LEFT, true);
    driven.until(
        [&] { return driven.window().snapshot().results[0].phase == palpate::contact::Phase::kPull; }, kSlow);
    wheel(driven, -13);
  } else {
    wheel(driven, 22);
    wheel(driven, -6);
    wheel(driven, 6);
  }
  driven.window().hold_full_quality();
  driven.frames(1);  // the panels still say how the moving pictures before it were
  palpate::render::write_png(driven.window().picture(), file);
  Driven::close();
  driven.frames(1);
  (void)driven.finish();
}

/// The viewer on a recording of a press, paused where it is nearly deepest, with the displacement map.
void viewer(const std::filesystem::path& file) {
  const std::filesystem::path recording = std::filesystem::temp_directory_path() / "press.h5";
  (void)palpate::session::Session(palpate::scene::load({})).run({recording, true});
  {
    palpate::app::ViewerOptions options;
    options.at_s = 2.4;
    options.map_range = 10e-3;
    palpate::app::DrivenViewer driven(recording, options);
    driven.until_there();
    driven.until_still();
    driven.frames(2);
    palpate::render::write_png(driven.viewer().picture(), file);
    Driven::close();
    driven.frames(1);
  }
  std::filesystem::remove(recording);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("usage: palpate_window_pictures FOLDER");
    const palpate::app::VirtualDisplay display;
    if (!display.there()) throw std::runtime_error("there is no Xvfb (Debian package xvfb)");
    const std::filesystem::path folder = argv[1];
    viewer(folder / "window-view.png");
    experiment(folder / "window.png", "press");
    experiment(folder / "window-pull.png", "pull");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "palpate_window_pictures: " << error.what() << '\n';
    return 2;
  }
}
