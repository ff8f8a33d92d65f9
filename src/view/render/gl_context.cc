#include "view/render/gl_context.h"

#include <stdexcept>

#include <SDL.h>
#include <epoxy/gl.h>
#include <fmt/core.h>

namespace palpate::render {
namespace {

constexpr int kWantedVersion = 33;  // OpenGL 3.3 in epoxy's numbering

[[noreturn]] void refuse(const std::string& what) {
  throw std::runtime_error("no picture can be drawn: " + what +
                           "; OpenGL 3.3 without a display comes with the Debian packages libegl1 and "
                           "libgl1-mesa-dri");
}

}  // namespace

GlContext::GlContext() {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the program handles Ctrl-C itself
  SDL_SetHintWithPriority(SDL_HINT_VIDEODRIVER, "offscreen", SDL_HINT_OVERRIDE);
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
    refuse(std::string("SDL's offscreen video driver does not start (") + SDL_GetError() + ")");
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* window = SDL_CreateWindow("palpate", 0, 0, 16, 16, SDL_WINDOW_OPENGL | SDL_WINDOW_HIDDEN);
  SDL_GLContext context = window != nullptr ? SDL_GL_CreateContext(window) : nullptr;
  const int version = context != nullptr ? epoxy_gl_version() : 0;
  if (version < kWantedVersion) {
    const std::string why = context == nullptr
                                ? std::string("no OpenGL context (") + SDL_GetError() + ")"
                                : fmt::format("OpenGL {}.{} is too old", version / 10, version % 10);
    if (context != nullptr) SDL_GL_DeleteContext(context);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    refuse(why);
  }
  window_ = window;
  context_ = context;
}

GlContext::~GlContext() {
  SDL_GL_DeleteContext(context_);
  SDL_DestroyWindow(static_cast<SDL_Window*>(window_));
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
}

void GlContext::make_current() {
  if (SDL_GL_MakeCurrent(static_cast<SDL_Window*>(window_), context_) != 0)
    throw std::runtime_error(std::string("the OpenGL context cannot be used on this thread: ") +
                             SDL_GetError());
}

void GlContext::release() noexcept { SDL_GL_MakeCurrent(static_cast<SDL_Window*>(window_), nullptr); }

}  // namespace palpate::render
