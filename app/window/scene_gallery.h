#pragma once
#include <map>
#include <string>
#include <string_view>

#include "io/scene/builtin_scenes.h"

namespace palpate::app {

/// Dialog of the built-in scenes, each with a picture and a line. All members: [setup], the window's thread,
/// between ImGui's NewFrame and Render.
class SceneGallery final {
 public:
  /// What the user chose in a frame.
  struct Choice {
    const scene::BuiltinScene* scene = nullptr;
    bool browse = false;  // for a scene file
  };

  void open() noexcept { open_ = just_opened_ = true; }
  [[nodiscard]] bool is_open() const noexcept { return open_; }
  /// Draws the dialog while it is open.
  [[nodiscard]] Choice draw();

 private:
  [[nodiscard]] bool draw_card(std::string_view name, std::string_view title, std::string_view line);
  [[nodiscard]] unsigned texture_of(std::string_view name);

  bool open_ = false;
  bool just_opened_ = false;
  std::map<std::string, unsigned, std::less<>> textures_;  // OpenGL; they end with the window's context
};

/// [any] The device with which the user takes over another scene: that of this one if a person holds it, else
/// the mouse.
[[nodiscard]] std::string device_for_user(const scene::Scene& scene);

}  // namespace palpate::app
