#pragma once
#include <stdexcept>
#include <string>

struct SDL_Window;

namespace palpate::app {

/// [any] Whether this program could show a window: DISPLAY or WAYLAND_DISPLAY is set.
[[nodiscard]] bool display_there();

/// There can be no window; the words say why.
class NoWindow final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The display has gone while there was a window on it (its server ended, its cable of a network was cut), or
/// the graphics card lost what was on it. Nothing can be drawn any more; everything else goes on.
class DisplayLost final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The program's one window with an OpenGL 3.3 core context, current on the thread that made it. All members:
/// [setup], that thread.
class Display final {
 public:
  struct Size {
    int width = 0;
    int height = 0;
  };

  /// From here on every member throws DisplayLost when the display goes, instead of ending the program as X
  /// would. @param size in the window system's units @throws NoWindow
  Display(const std::string& title, Size size);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  [[nodiscard]] SDL_Window* window() const noexcept { return window_; }
  [[nodiscard]] void* context() const noexcept { return context_; }
  /// In the window system's units, which events use too.
  [[nodiscard]] Size size() const;
  /// In pixels.
  [[nodiscard]] Size pixels() const;
  /// How much larger than at 96 dots an inch things are to be drawn, 1 to 3.
  [[nodiscard]] float scale() const;
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Whether the display has gone; then nothing here may be called any more, and its end touches nothing.
  [[nodiscard]] bool lost() const noexcept;
  /// The graphics card has lost what was on it, so that the display is as good as gone. @throws DisplayLost
  [[noreturn]] void give_up() const;
  /// Shows what was drawn.
  void swap();

 private:
  void close() noexcept;

  SDL_Window* window_ = nullptr;
  void* context_ = nullptr;  // SDL_GLContext
};

}  // namespace palpate::app
