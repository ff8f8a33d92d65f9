#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <SDL.h>

#include "palpate/offscreen.h"

#include "app/window/display.h"

namespace palpate::app {

/// Where things are in the window [window units, y down].
struct Rectangle {
  float x = 0.0F;
  float y = 0.0F;
  float width = 0.0F;
  float height = 0.0F;
};

/// Words across the picture.
struct Banner {
  std::string text;
  bool fault = false;
};

/// How large letters and panels are asked to be; nothing: as the display's dots an inch say.
struct UiScale {
  static constexpr double kLeast = 0.5;
  static constexpr double kMost = 4.0;

  /// [setup] From --ui-scale, else from PALPATE_UI_SCALE. @throws InputError naming it when it is no number
  /// from kLeast to kMost.
  [[nodiscard]] static std::optional<float> asked(const std::string& flag);
};

/// A window with panels in it: the display, ImGui, and the mouse as its events say. All members: [setup], one
/// thread, the one that made it.
class Viewport final {
 public:
  /// @param scale of letters and panels; nothing: as the display says @throws NoWindow
  Viewport(const std::string& title, Display::Size size, std::optional<float> scale);
  ~Viewport();
  Viewport(const Viewport&) = delete;
  Viewport& operator=(const Viewport&) = delete;

  [[nodiscard]] Display& display() noexcept { return display_; }
  /// Of letters and panels, in window units.
  [[nodiscard]] float scale() const noexcept { return scale_; }
  [[nodiscard]] Display::Size pixels() const { return display_.pixels(); }
  /// Pixels a window unit.
  [[nodiscard]] double enlarged() const;

  /// Takes all that has happened since the last call, and hands it on with the way that the mouse has come
  /// with a motion [window units]. Names of dropped files live until `taker` returns.
  void take_events(const std::function<void(const SDL_Event& event, std::pair<int, int> way)>& taker);
  [[nodiscard]] std::pair<int, int> mouse_at() const noexcept { return mouse_at_; }
  /// Whether a place lies in a rectangle and no panel is over it.
  [[nodiscard]] static bool over(const Rectangle& place, int x, int y);

  /// Panels are drawn between the two.
  void begin_panels();
  static void end_panels();
  /// The window's ground, then the panels over what was drawn meanwhile.
  void clear();
  static void draw_panels();
  /// Shows the frame.
  void show() { display_.swap(); }

  /// Words at the picture's lower edge for some seconds.
  void show_message(std::string message);
  /// What is said now; empty: nothing.
  [[nodiscard]] const std::string& message() const noexcept { return message_; }
  /// Saves a picture in the working folder under the time, and says where, or why not.
  void save(const render::Image& image);
  /// Over the picture, if there is room: strips of words from its top down, a title and how to get help, and
  /// what is said. @return y below the strips
  float draw_overlay(const Rectangle& picture, const std::vector<Banner>& banners, const std::string& title);

  /// All of the window, as last drawn.
  [[nodiscard]] render::Image picture() const;
  /// Whether the graphics card has lost what was on it: nothing can be drawn any more.
  [[nodiscard]] bool graphics_lost() const;
  /// Whether memory for pictures ran out since the last call.
  [[nodiscard]] static bool out_of_memory();

 private:
  void take(const SDL_Event& event);
  void take_key(const SDL_Keysym& key);
  void take_mouse(const SDL_MouseButtonEvent& button);
  void look_at_scale();

  Display display_;
  std::optional<float> asked_;
  float scale_ = 1.0F;
  double pixels_a_unit_ = 1.0;
  std::string message_;
  std::int64_t message_until_ns_ = 0;
  bool scale_may_differ_ = false;
  bool keys_in_panels_ = false;  // arrows, Space and Enter go there
  std::pair<int, int> mouse_at_{-1, -1};
  std::uint32_t mouse_down_ = 0;     // ImGui's buttons, a bit each
  std::uint32_t mouse_pressed_ = 0;  // in this frame: a click within a frame counts
};

/// [setup] "palpate-DATE-TIME.ENDING" in the working folder.
[[nodiscard]] std::filesystem::path named_by_time(const std::string& ending);

}  // namespace palpate::app
