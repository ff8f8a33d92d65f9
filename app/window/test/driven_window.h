#pragma once
// Drives a window by synthetic events, for tests.
#include <chrono>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <SDL.h>
#include <imgui_internal.h>

#include "app/window/viewer.h"
#include "app/window/window.h"

namespace palpate::app {

/// A user of a window.
class Driven {
 public:
  virtual ~Driven() = default;
  Driven() = default;
  Driven(const Driven&) = delete;
  Driven& operator=(const Driven&) = delete;

  /// Runs frames until `done` is true. @return false after this time, which is long enough for slow machines
  bool until(const std::function<bool()>& done, double seconds = 60.0) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!done()) {
      if (!alive_ || std::chrono::steady_clock::now() > give_up) return done();
      alive_ = frame();
    }
    return true;
  }
  void frames(int number) {
    for (int i = 0; i < number && alive_; ++i) alive_ = frame();
  }
  /// Whether the last frame kept the window open.
  [[nodiscard]] bool alive() const noexcept { return alive_; }

  /// Presses and releases a key, with a frame between.
  void key(SDL_Keycode which, Uint16 modifiers = KMOD_NONE) {
    SDL_SetModState(static_cast<SDL_Keymod>(modifiers));
    for (const Uint32 type : {SDL_KEYDOWN, SDL_KEYUP}) {
      SDL_Event event{};
      event.type = type;
      event.key.keysym.sym = which;
      event.key.keysym.scancode = SDL_GetScancodeFromKey(which);
      event.key.keysym.mod = modifiers;
      SDL_PushEvent(&event);
      frames(1);
    }
    if (modifiers != KMOD_NONE) release_modifiers();
  }
  /// Types text into the focused field.
  void type(const std::string& words) {
    for (const char letter : words) {
      SDL_Event event{};
      event.type = SDL_TEXTINPUT;
      event.text.text[0] = letter;
      SDL_PushEvent(&event);
      frames(1);
    }
  }
  void move(int x, int y) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.x = x;
    event.motion.y = y;
    event.motion.xrel = x - x_;
    event.motion.yrel = y - y_;
    SDL_PushEvent(&event);
    x_ = x;
    y_ = y;
  }
  void button(Uint8 which, bool down) const {
    SDL_Event event{};
    event.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
    event.button.button = which;
    event.button.x = x_;
    event.button.y = y_;
    SDL_PushEvent(&event);
  }
  /// Presses and releases the left button at the mouse position.
  void click() {
    for (const bool down : {true, false}) {
      button(SDL_BUTTON_LEFT, down);
      frames(2);
    }
  }
  /// Clicks while a key such as KMOD_CTRL is held.
  void click_with(Uint16 modifiers) {
    SDL_SetModState(static_cast<SDL_Keymod>(modifiers));
    SDL_Event event{};  // ImGui reads the modifiers when a button is pressed
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = SDLK_LCTRL;
    event.key.keysym.scancode = SDL_SCANCODE_LCTRL;
    event.key.keysym.mod = modifiers;
    SDL_PushEvent(&event);
    click();
    release_modifiers();
  }
  static void wheel(int notches) {
    SDL_Event event{};
    event.type = SDL_MOUSEWHEEL;
    event.wheel.y = notches;
    SDL_PushEvent(&event);
  }
  static void drop(const std::string& file) {
    SDL_Event event{};
    event.type = SDL_DROPFILE;
    event.drop.file = SDL_strdup(file.c_str());
    SDL_PushEvent(&event);
  }
  static void close() {
    SDL_Event event{};
    event.type = SDL_WINDOWEVENT;
    event.window.event = SDL_WINDOWEVENT_CLOSE;
    SDL_PushEvent(&event);
  }
  static void resize(int width, int height) { SDL_SetWindowSize(SDL_GetWindowFromID(1), width, height); }
  void move_to_middle(const Rectangle& place) {
    move(static_cast<int>(place.x + 0.5F * place.width), static_cast<int>(place.y + 0.5F * place.height));
  }

  /// Moves the mouse onto a visible widget of a panel. @param path its ImGui window, further parts of its
  /// ImGui identity, its label @return whether it was found
  bool point_at(std::initializer_list<std::string_view> path) {
    ImGuiID wanted = 0;
    for (const std::string_view name : path) wanted = ImHashStr(name.data(), name.size(), wanted);
    const std::string window(*path.begin());
    for (int attempt = 0; attempt < 10; ++attempt) {  // an opened panel may move for some frames
      const std::optional<ImVec2> middle = middle_of(window, wanted);
      if (middle) move(static_cast<int>(middle->x), static_cast<int>(middle->y));
      frames(1);
      if (ImGui::GetCurrentContext()->HoveredId == wanted) return true;
    }
    return false;
  }
  /// Points at a widget and presses the left button. @return whether it was found
  bool press(std::initializer_list<std::string_view> path) {
    if (!point_at(path)) return false;
    click();
    return true;
  }

 protected:
  virtual bool frame() = 0;

 private:
  /// Centre of a widget. ImGui stores the rectangle of the focused item, so this focuses the widget for one
  /// frame.
  std::optional<ImVec2> middle_of(const std::string& name, ImGuiID wanted) {
    ImGuiContext& all = *ImGui::GetCurrentContext();
    ImGuiWindow* window = ImGui::FindWindowByName(name.c_str());
    if (window == nullptr) return std::nullopt;
    const auto keyboard = std::tuple(all.NavWindow, all.NavId, all.NavLayer, all.NavFocusScopeId);
    all.NavWindow = window;
    all.NavId = wanted;
    frames(1);
    const bool found = all.NavIdIsAlive && all.NavId == wanted;
    const ImRect place = ImGui::WindowRectRelToAbs(window, window->NavRectRel[all.NavLayer]);
    std::tie(all.NavWindow, all.NavId, all.NavLayer, all.NavFocusScopeId) = keyboard;
    return found ? std::optional(place.GetCenter()) : std::nullopt;
  }
  void release_modifiers() {
    SDL_SetModState(KMOD_NONE);
    SDL_Event event{};
    event.type = SDL_KEYUP;
    event.key.keysym.sym = SDLK_LCTRL;
    event.key.keysym.scancode = SDL_SCANCODE_LCTRL;
    SDL_PushEvent(&event);
    frames(1);
  }

  bool alive_ = true;
  int x_ = 0;
  int y_ = 0;
};

/// Window with a new session.
class DrivenWindow final : public Driven {
 public:
  explicit DrivenWindow(const scene::Overrides& request, WindowOptions options = {})
      : session_(prepare(scene::load(request), options.duration_s, false)),
        window_(session_, request, std::move(options)) {}

  [[nodiscard]] Window& window() noexcept { return window_; }
  [[nodiscard]] Session& session() noexcept { return *session_; }
  void move_to_picture() { move_to_middle(window_.layout().picture); }
  WindowOutcome finish() { return window_.finish(); }

 private:
  bool frame() override { return window_.frame(); }

  std::shared_ptr<Session> session_;
  Window window_;
};

/// Viewer of a recording.
class DrivenViewer final : public Driven {
 public:
  explicit DrivenViewer(const std::filesystem::path& recording, const ViewerOptions& options = {})
      : viewer_(std::make_unique<RecordedView>(recording, false), options) {}

  [[nodiscard]] Viewer& viewer() noexcept { return viewer_; }
  /// Runs frames until the requested tick is shown.
  bool until_there() {
    frames(2);
    return until([this] { return viewer_.there(); });
  }
  bool until_still() {
    return until([this] { return viewer_.still(); });
  }

 private:
  bool frame() override { return viewer_.frame(); }

  Viewer viewer_;
};

}  // namespace palpate::app
