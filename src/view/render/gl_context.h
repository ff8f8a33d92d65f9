#pragma once
#include <string>

namespace palpate::render {

/// An OpenGL 3.3 core context without a display: SDL's `offscreen` video driver over EGL. The only place
/// where the program starts SDL's video: one video driver a process.
class GlContext final {
 public:
  /// [setup] Makes the context and makes it current on the calling thread.
  /// @throws std::runtime_error saying which packages are missing when none can be had.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// [setup] Makes the context current on the calling thread; no other thread may hold it.
  void make_current();
  /// [setup] Lets the context go, so that another thread may draw.
  void release() noexcept;

 private:
  void* window_ = nullptr;   // SDL_Window
  void* context_ = nullptr;  // SDL_GLContext
};

}  // namespace palpate::render
