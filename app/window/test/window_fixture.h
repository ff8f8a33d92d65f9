#pragma once
// Fixture for window tests: a display, a session that is quick to prepare, and measures of a picture.
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/not_tested.h"
#include "io/system/test/own_cache.h"
#include "io/system/test/temporary_folder.h"

#include "app/window/test/driven_window.h"
#include "app/window/test/virtual_display.h"

namespace palpate::app {

/// Options for small pictures, because they are drawn without a graphics card.
inline WindowOptions small(std::filesystem::path recording = {}) {
  WindowOptions options;
  options.size = {500, 300};
  options.scale = 0.5F;
  options.recording = std::move(recording);
  return options;
}

/// Options of a window whose text and panels have their usual size.
inline WindowOptions full_scale() {
  WindowOptions options;
  options.size = {1000, 600};
  return options;
}

/// Scene with a ball as organ, which is quick to prepare, and a small ball as tool.
inline scene::Overrides ball(const std::string& device) {
  scene::Overrides request;
  request.organ = "ball";
  request.tissue = "liver";
  request.tools = {"sphere:5"};
  request.device = device;
  return request;
}

/// Emulated hand whose device has a fault of this kind at this time.
inline scene::Overrides failing(const std::filesystem::path& file, const std::string& kind,
                                const std::string& time_s, const std::string& duration_s) {
  std::ofstream(file) << "[organ]\nmesh = \"ball\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n"
                         "[device]\nkind = \"emulated\"\n[[device.fault]]\nkind = \"" +
                             kind + "\"\ntime_s = " + time_s + "\nduration_s = " + duration_s + "\n";
  scene::Overrides request;
  request.scene = file;
  return request;
}

/// Shows a run whose device fails, until the banner says so. A busy computer may stall the loop before, which
/// is another fault: then the run is shown again.
inline void show_failure(std::optional<DrivenWindow>& shown, const scene::Overrides& request,
                         const WindowOptions& options) {
  for (int attempt = 0; attempt < 5; ++attempt) {
    shown.emplace(request, options);
    ASSERT_TRUE(shown->until([&] { return !shown->window().banner().empty(); }));
    if (shown->window().banner().find("the loop stood still") == std::string::npos) return;
  }
}

class WindowTest : public testing::Test {
 protected:
  WindowTest() { display().use(); }
  /// Whether a display is available. If not, prints the reason; the test must then return.
  [[nodiscard]] static bool display_is_there() {
    if (display().there()) return true;
    test::not_tested("there is no Xvfb (Debian package xvfb)");
    return false;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  /// One for all tests of a process.
  static const VirtualDisplay& display() {
    static const VirtualDisplay display;
    return display;
  }

  test::TemporaryFolder folder_;
};

/// Pixels of a rectangle of a picture, row by row.
inline std::vector<std::uint8_t> cut_out(const render::Image& image, const Rectangle& place) {
  std::vector<std::uint8_t> part;
  for (int y = static_cast<int>(place.y); y < static_cast<int>(place.y + place.height); ++y) {
    const auto row = image.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(y) * image.width;
    part.insert(part.end(), row + 3 * static_cast<std::ptrdiff_t>(place.x),
                row + 3 * static_cast<std::ptrdiff_t>(place.x + place.width));
  }
  return part;
}

/// Number of different colours in a rectangle of a picture: 1 if it is empty, many if it shows something.
inline std::size_t colours_in(const render::Image& image, const Rectangle& place) {
  std::set<std::uint32_t> colours;
  for (int y = static_cast<int>(place.y); y < static_cast<int>(place.y + place.height); ++y) {
    for (int x = static_cast<int>(place.x); x < static_cast<int>(place.x + place.width); ++x) {
      const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                 static_cast<std::size_t>(x));
      colours.insert(
          static_cast<std::uint32_t>(image.rgb[i] << 16 | image.rgb[i + 1] << 8 | image.rgb[i + 2]));
    }
  }
  return colours.size();
}

/// Fraction of the pixels that are much redder than green and blue.
inline double red_share(const render::Image& image, const Rectangle& place) {
  std::size_t red = 0;
  std::size_t all = 0;
  for (int y = static_cast<int>(place.y); y < static_cast<int>(place.y + place.height); ++y) {
    for (int x = static_cast<int>(place.x); x < static_cast<int>(place.x + place.width); ++x) {
      const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                 static_cast<std::size_t>(x));
      ++all;
      if (image.rgb[i] > 130 && image.rgb[i + 1] < 70 && image.rgb[i + 2] < 70) ++red;
    }
  }
  return static_cast<double>(red) / static_cast<double>(all);
}

/// Closes the window as the user does, and expects that it leaves at the next frame.
inline void close_and_expect_order(Driven& driven) {
  Driven::close();
  driven.frames(2);
  EXPECT_FALSE(driven.alive());
}

}  // namespace palpate::app
