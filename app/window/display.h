#pragma once
#include <stdexcept>
#include <string>

struct SDL_Window;

namespace palpate::app {

/// [any] Whether DISPLAY or WAYLAND_DISPLAY is set, so that this program might open a window.
[[nodiscard]] bool display_there();
/// [any] Why a run has no window when display_there() is false, for a message.
[[nodiscard]] const char* describe_no_display() noexcept;

/// No window can be opened; the message gives the reason.
class NoWindow final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The window lost its display (the X server ended, a network connection was cut) or the graphics card lost
/// its memory. Nothing can be drawn any more. The simulation continues.
class DisplayLost final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The program's one window, with an OpenGL 3.3 core context that is current on the constructing thread. All
/// members: [setup], that thread.
class Display final {
 public:
  struct Size {
    int width = 0;
    int height = 0;
  };

  /// Opens the window. When the display is lost later, every member throws DisplayLost instead of letting X
  /// end the program. @param size in window units of the window system @throws NoWindow
  Display(const std::string& title, Size size);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  [[nodiscard]] SDL_Window* window() const noexcept { return window_; }
  [[nodiscard]] void* context() const noexcept { return context_; }
  /// In window units of the window system, the units of mouse events.
  [[nodiscard]] Size size() const;
  /// In pixels.
  [[nodiscard]] Size pixels() const;
  /// Scale of text and panels, 1 to 3; 1 is for 96 dots per inch.
  [[nodiscard]] float scale() const;
  void set_title(const std::string& title);
  void toggle_full_screen();
  /// Whether the display is lost. Then no other member may be called, and the destructor touches nothing.
  [[nodiscard]] bool lost() const noexcept;
  /// Reports that the graphics card has lost its memory, and marks the display as lost. @throws DisplayLost
  [[noreturn]] void give_up() const;
  /// Shows what was drawn.
  void swap();

 private:
  void close() noexcept;

  SDL_Window* window_ = nullptr;
  void* context_ = nullptr;  // SDL_GLContext
};

}  // namespace palpate::app
