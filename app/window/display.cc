#include "app/window/display.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>

#include <SDL.h>
#include <dlfcn.h>
#include <epoxy/gl.h>

namespace palpate::app {
namespace {

constexpr int kWantedVersion = 33;  // OpenGL 3.3, in epoxy's notation
constexpr int kSmallestSide = 1;

bool names_something(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

/// Global because X calls the handlers below without a pointer to the object.
std::atomic<bool> display_is_lost{false};

constexpr const char* kGone = "the display is gone";

/// Handles a lost connection. X would exit the process at once and leave the device at its last force. The
/// exception passes through X, SDL and Mesa; they are C code with unwind tables, and none of them is called
/// afterwards.
extern "C" int x_connection_is_lost(void* /*display*/) {
  display_is_lost = true;
  throw DisplayLost(kGone);
}

/// Ignores requests that X refuses, for example for a window that another program has destroyed. X would exit
/// the process. The run continues without the requested drawing.
extern "C" int x_request_is_refused(void* /*display*/, void* /*event*/) { return 0; }

/// Installs the handlers if SDL has loaded X.
void install_loss_handlers() {
  using LossHandler = int (*)(void*);
  using ErrorHandler = int (*)(void*, void*);
  display_is_lost = false;
  const char* driver = SDL_GetCurrentVideoDriver();
  if (driver == nullptr || std::string(driver) != "x11") return;  // Wayland sends SDL_QUIT instead
  void* library = dlopen("libX11.so.6", RTLD_NOW | RTLD_NOLOAD);
  if (library == nullptr) return;
  const auto of_loss = reinterpret_cast<LossHandler (*)(LossHandler)>(dlsym(library, "XSetIOErrorHandler"));
  const auto of_error = reinterpret_cast<ErrorHandler (*)(ErrorHandler)>(dlsym(library, "XSetErrorHandler"));
  if (of_loss != nullptr) of_loss(&x_connection_is_lost);
  if (of_error != nullptr) of_error(&x_request_is_refused);
}

}  // namespace

const char* describe_no_display() noexcept { return "there is no display"; }

bool display_there() { return names_something("DISPLAY") || names_something("WAYLAND_DISPLAY"); }

Display::Display(const std::string& title, Size size) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the program handles Ctrl-C itself
  SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
  SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
  // Without a display SDL would choose a driver that shows nothing.
  if (!names_something("SDL_VIDEODRIVER") && !names_something("WAYLAND_DISPLAY")) {
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");
  }
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) {
    throw NoWindow(std::string("no window can be opened: ") + SDL_GetError());
  }
  install_loss_handlers();
  if (SDL_Rect usable; SDL_GetDisplayUsableBounds(0, &usable) == 0) {
    size = {std::min(size.width, usable.w), std::min(size.height, usable.h)};
  }
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
  // Ask the driver to report lost memory. Otherwise its calls would silently do nothing.
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_FLAGS, SDL_GL_CONTEXT_ROBUST_ACCESS_FLAG);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_RESET_NOTIFICATION, SDL_GL_CONTEXT_RESET_LOSE_CONTEXT);
  window_ =
      SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, size.width, size.height,
                       SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
  if (window_ != nullptr) context_ = SDL_GL_CreateContext(window_);
  if (window_ != nullptr && context_ == nullptr) {  // the driver has no robust contexts
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_FLAGS, 0);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_RESET_NOTIFICATION, SDL_GL_CONTEXT_RESET_NO_NOTIFICATION);
    context_ = SDL_GL_CreateContext(window_);
  }
  if (context_ == nullptr || epoxy_gl_version() < kWantedVersion) {
    const std::string why = context_ == nullptr ? SDL_GetError() : "its OpenGL is older than 3.3";
    close();
    throw NoWindow("no window can be opened: " + why);
  }
  SDL_SetWindowMinimumSize(window_, kSmallestSide, kSmallestSide);
  SDL_GL_SetSwapInterval(1);
  SDL_EventState(SDL_DROPFILE, SDL_ENABLE);
}

Display::~Display() { close(); }

bool Display::lost() const noexcept { return display_is_lost; }

void Display::give_up() const {
  display_is_lost = true;
  throw DisplayLost("the graphics card has lost the window's picture");
}

void Display::close() noexcept {
  if (display_is_lost) return;
  if (context_ != nullptr) SDL_GL_DeleteContext(context_);
  if (window_ != nullptr) SDL_DestroyWindow(window_);
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
}

Display::Size Display::size() const {
  Size size;
  SDL_GetWindowSize(window_, &size.width, &size.height);
  return size;
}

Display::Size Display::pixels() const {
  Size size;
  SDL_GL_GetDrawableSize(window_, &size.width, &size.height);
  return size;
}

float Display::scale() const {
  constexpr float kPlain = 96.0F;  // dots per inch
  float dots = kPlain;
  const int where = SDL_GetWindowDisplayIndex(window_);
  if (where < 0 || SDL_GetDisplayDPI(where, nullptr, &dots, nullptr) != 0) dots = kPlain;
  // If the window system already enlarges the window, its units are larger than pixels.
  const Size units = size();
  const float enlarged =
      units.width > 0 ? static_cast<float>(pixels().width) / static_cast<float>(units.width) : 1.0F;
  return std::clamp(std::round(4.0F * dots / (kPlain * std::max(1.0F, enlarged))) / 4.0F, 1.0F, 3.0F);
}

void Display::set_title(const std::string& title) { SDL_SetWindowTitle(window_, title.c_str()); }

void Display::toggle_full_screen() {
  const bool full = (SDL_GetWindowFlags(window_) & SDL_WINDOW_FULLSCREEN_DESKTOP) != 0;
  SDL_SetWindowFullscreen(window_, full ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
}

void Display::swap() { SDL_GL_SwapWindow(window_); }

}  // namespace palpate::app
