#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <SDL.h>

#include "palpate/offscreen.h"

#include "app/window/display.h"
#include "app/window/input_queue.h"
#include "app/window/theme.h"

namespace palpate::app {

/// Rectangle of the window [window units, y down].
struct Rectangle {
  float x = 0.0F;
  float y = 0.0F;
  float width = 0.0F;
  float height = 0.0F;
};

/// Text across the picture.
struct Banner {
  std::string text;
  bool fault = false;
};

/// Window with panels: the display, ImGui, and the mouse position from events. All members: [setup], the
/// constructing thread.
class Viewport final {
 public:
  /// @param scale of text and panels; nothing: from the display @param fonts besides the panels' @throws
  /// NoWindow
  Viewport(const std::string& title, Display::Size size, std::optional<float> scale,
           std::vector<ExtraFont> fonts = {});
  ~Viewport();
  Viewport(const Viewport&) = delete;
  Viewport& operator=(const Viewport&) = delete;

  /// Makes this window the one that OpenGL and ImGui draw to, for a program with several windows.
  void activate() const;
  [[nodiscard]] Display& display() noexcept { return display_; }
  /// Scale of text and panels in window units.
  [[nodiscard]] float scale() const noexcept { return scale_; }
  /// Changes the scale at the next begin_panels().
  void set_scale(float scale);
  [[nodiscard]] Display::Size pixels() const { return display_.pixels(); }
  /// Pixels per window unit.
  [[nodiscard]] double enlarged() const;

  /// Passes all events since the last call to `taker`, each with the mouse's displacement [window units]. The
  /// name of a dropped file is valid until `taker` returns. @param stop set by Ctrl-C; may be null
  /// @return whether the window is to close: the user closed it, or `stop` is set
  [[nodiscard]] bool take_events(
      const std::atomic<bool>* stop,
      const std::function<void(const SDL_Event& event, std::pair<int, int> way)>& taker);
  /// Passes one event to ImGui and the mouse position.
  void take(const SDL_Event& event);
  [[nodiscard]] std::pair<int, int> mouse_at() const noexcept { return mouse_at_; }
  /// Whether a point is inside a rectangle and not covered by a panel.
  [[nodiscard]] static bool over(const Rectangle& place, int x, int y);

  /// Begin and end the drawing of panels.
  void begin_panels();
  static void end_panels();
  /// Clears the window with the background colour.
  void clear();
  /// Draws the panels over the picture.
  static void draw_panels();
  /// Shows the frame.
  void show() { display_.swap(); }

  /// Shows a message at the picture's lower edge for some seconds.
  void show_message(std::string message);
  /// The current message; empty: none.
  [[nodiscard]] const std::string& message() const noexcept { return message_; }
  /// Saves a picture in the working folder, named by date and time, and shows a message with the file or the
  /// error.
  void save(const render::Image& image);
  /// Draws over the picture if there is enough space: banners from the top down, title and help key, message.
  /// @return y below the banners
  float draw_overlay(const Rectangle& picture, const std::vector<Banner>& banners, const std::string& title);

  /// The whole window as last drawn.
  [[nodiscard]] render::Image picture() const;
  /// Whether the graphics card has lost its memory, so that nothing can be drawn any more.
  [[nodiscard]] bool graphics_lost() const;
  /// Whether memory for pictures ran out since the last call.
  [[nodiscard]] static bool out_of_memory();

 private:
  void take_key(const SDL_Keysym& key);
  void take_mouse(const SDL_MouseButtonEvent& button);
  void pass_input();
  void look_at_scale();

  Display display_;
  ImGuiContext* context_ = nullptr;
  std::vector<ExtraFont> fonts_;
  std::optional<float> asked_;
  float scale_ = 1.0F;
  double pixels_a_unit_ = 1.0;
  std::string message_;
  std::int64_t message_until_ns_ = 0;
  bool scale_may_differ_ = false;
  bool keys_in_panels_ = false;  // arrows, Space and Enter belong to the panels
  std::pair<int, int> mouse_at_{-1, -1};
  InputQueue input_;  // for the panels
};

}  // namespace palpate::app
