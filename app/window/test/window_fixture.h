#pragma once
// What the tests of windows share: a display of their own, a quick session, and what stands in a picture.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

#include "app/window/test/driven_window.h"
#include "app/window/test/virtual_display.h"

namespace palpate::app {

/// Small pictures: they are drawn without a graphics card, beside other tests.
inline WindowOptions small(std::filesystem::path recording = {}) {
  WindowOptions options;
  options.size = {1000, 600};
  options.recording = std::move(recording);
  return options;
}

/// A ball, quickly prepared, under a small ball as tool.
inline scene::Overrides ball(const std::string& device) {
  scene::Overrides request;
  request.organ = "ball";
  request.tissue = "liver";
  request.tools = {"sphere:5"};
  request.device = device;
  return request;
}

/// A device that fails in a way and at a time, in the emulated hand.
inline scene::Overrides failing(const std::filesystem::path& file, const std::string& kind,
                                const std::string& time_s, const std::string& duration_s) {
  std::ofstream(file) << "[organ]\nmesh = \"ball\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n"
                         "[device]\nkind = \"emulated\"\n[[device.fault]]\nkind = \"" +
                             kind + "\"\ntime_s = " + time_s + "\nduration_s = " + duration_s + "\n";
  scene::Overrides request;
  request.scene = file;
  return request;
}

class WindowTest : public testing::Test {
 protected:
  /// Whether there is a display; else the reason is said, and the test can show nothing.
  [[nodiscard]] bool display_is_there() const {
    if (display_.there()) return true;
    std::cerr << "not tested: there is no Xvfb (Debian package xvfb)\n";
    return false;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
  [[nodiscard]] const VirtualDisplay& display() const { return display_; }

 private:
  test::TemporaryFolder folder_;
  VirtualDisplay display_;
};

/// The pixels of a part of a picture, row by row.
inline std::vector<std::uint8_t> cut_out(const render::Image& image, const Rectangle& place) {
  std::vector<std::uint8_t> part;
  for (int y = static_cast<int>(place.y); y < static_cast<int>(place.y + place.height); ++y) {
    const auto row = image.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(y) * image.width;
    part.insert(part.end(), row + 3 * static_cast<std::ptrdiff_t>(place.x),
                row + 3 * static_cast<std::ptrdiff_t>(place.x + place.width));
  }
  return part;
}

/// How many different colours there are in a part of a picture: 1 in an empty one, many where things are.
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

/// Share of the pixels that are much redder than green and blue.
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

/// The user closes the window.
inline void close_and_expect_order(Driven& driven) {
  Driven::close();
  driven.frames(2);
  EXPECT_FALSE(driven.alive());
}

}  // namespace palpate::app
