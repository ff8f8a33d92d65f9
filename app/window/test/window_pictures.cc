// Draws the pictures of the window in docs/pictures: palpate_window_pictures FOLDER
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

constexpr double kSlow = 240.0;  // s: long enough without a graphics card

/// Turns the wheel by single notches, as a user would.
void wheel(DrivenWindow& driven, int notches) {
  const int one = notches > 0 ? 1 : -1;
  for (int i = 0; i != notches; i += one) {
    Driven::wheel(one);
    const double from = driven.window().traces().newest_time();
    driven.until([&] { return driven.window().traces().newest_time() > from + 0.08; }, kSlow);
  }
}

/// Press or pull by mouse and hold, with all panels open.
void experiment(const std::filesystem::path& file, const char* task) {
  palpate::scene::Overrides request;
  request.task = task;
  request.device = "mouse";
  DrivenWindow driven(request);
  driven.until([&] { return driven.window().snapshot().hands == 1; }, kSlow);
  const auto place = driven.window().in_window(driven.window().snapshot().results[0].nearest_W);
  if (!place) throw std::runtime_error("the tool is behind the camera");
  driven.move(static_cast<int>(place->first), static_cast<int>(place->second));
  if (std::string(task) == "pull") {
    wheel(driven, 5);
    driven.button(SDL_BUTTON_LEFT, true);
    driven.until(
        [&] { return driven.window().snapshot().results[0].phase == palpate::contact::Phase::kPull; }, kSlow);
    wheel(driven, -13);
  } else {
    wheel(driven, 17);
    wheel(driven, -6);
    wheel(driven, 6);
  }
  driven.window().hold_full_quality();
  driven.frames(1);  // the panels still show the rates of the moving pictures
  palpate::render::write_png(driven.window().picture(), file);
  Driven::close();
  driven.frames(1);
  (void)driven.finish();
}

/// Search of a liver by the default path, shortly before its end, with the map of the felt stiffness.
void search(const std::filesystem::path& file) {
  palpate::scene::Overrides request;
  request.scene_text = {
      "[scene]\nname = \"search\"\ntask = \"palpate\"\nseed = 7\n[organ]\nmesh = "
      "\"liver\"\n[search]\nradius_mm = 6\n"
      "depth_mm = 9\n[tool]\nmesh = \"sphere:5\"\n[path]\nspeed = 1.5\n",
      {}};
  DrivenWindow driven(request);
  driven.frames(3);
  driven.key(SDLK_t);
  driven.until([&] { return driven.window().traces().newest_time() > 68.0; }, kSlow);
  driven.window().hold_full_quality();
  driven.frames(1);
  palpate::render::write_png(driven.window().picture(), file);
  Driven::close();
  driven.frames(1);
  (void)driven.finish();
}

/// Viewer of a press, paused near the largest depth, with the displacement map.
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
    search(folder / "window-search.png");
    viewer(folder / "window-view.png");
    experiment(folder / "window.png", "press");
    experiment(folder / "window-pull.png", "pull");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "palpate_window_pictures: " << error.what() << '\n';
    return 2;
  }
}
