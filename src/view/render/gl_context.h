#pragma once
#include <string>

namespace palpate::render {

/// An OpenGL 3.3 core context without a display, by SDL's `offscreen` video driver over EGL. A process can
/// use only one SDL video driver.
class GlContext final {
 public:
  /// [setup] Creates the context and makes it current on the calling thread. @throws std::runtime_error that
  /// names the missing packages.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// [setup] Makes the context current on the calling thread; it must not be current on another.
  void make_current();
  /// [setup] Releases the context, so that another thread can draw.
  void release() noexcept;

 private:
  [[maybe_unused]] void* window_ = nullptr;   // SDL_Window
  [[maybe_unused]] void* context_ = nullptr;  // SDL_GLContext
};

}  // namespace palpate::render
