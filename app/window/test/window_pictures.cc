// Pictures of the window for docs/pictures, on a display of their own: palpate_window_pictures FOLDER
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include "palpate/render/offscreen.h"

#include "app/window/test/driven_window.h"
#include "app/window/test/virtual_display.h"

namespace {

using palpate::app::DrivenWindow;

constexpr double kSlow = 240.0;  // s: this machine may have no graphics card

bool deep(DrivenWindow& driven, double time) {
  return driven.until([&] { return driven.window().traces().newest_time() > time; }, kSlow);
}

/// The scripted press or pull at its deepest, all panels there.
void experiment(const std::filesystem::path& file, const char* task) {
  palpate::scene::Request request;
  request.task = task;
  DrivenWindow driven(request);
  const double when = std::string(task) == "pull" ? 6.4 : 3.6;
  deep(driven, when);
  driven.key(SDLK_SPACE);  // the picture is held while it is made fine
  driven.frames(3);
  driven.window().hold_full_quality();
  driven.key(SDLK_SPACE);
  driven.frames(4);
  palpate::render::write_png(driven.window().picture(), file);
  driven.close();
  driven.frames(1);
  (void)driven.finish();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("usage: palpate_window_pictures FOLDER");
    const palpate::app::VirtualDisplay display;
    if (!display.there()) throw std::runtime_error("there is no Xvfb (Debian package xvfb)");
    const std::filesystem::path folder = argv[1];
    experiment(folder / "window.png", "press");
    experiment(folder / "window-pull.png", "pull");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "palpate_window_pictures: " << error.what() << '\n';
    return 2;
  }
}
