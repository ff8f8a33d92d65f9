#pragma once

// The OpenGL functions of the renderer: OpenGL 3.3, or WebGL2 (OpenGL ES 3.0) in a browser.
#ifdef __EMSCRIPTEN__
#include <GLES3/gl3.h>
#else
#include <epoxy/gl.h>
#endif

namespace palpate::render {

#ifdef __EMSCRIPTEN__

// WebGL2 has none of these states. shaders::position_vertex() clamps depths itself.
inline void clamp_depths(bool /*on*/) {}
inline void shade_samples(bool /*on*/) {}
inline void enable_multisampling() {}

// A browser's glFinish() returns at once; reading a pixel waits for the picture.
inline void finish_drawing() {
  unsigned char pixel[4];
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
}

#else

/// Draws what lies in front of the near plane or behind the far plane at the depth of that plane.
inline void clamp_depths(bool on) { on ? glEnable(GL_DEPTH_CLAMP) : glDisable(GL_DEPTH_CLAMP); }

/// Runs the fragment shader for each sample of a pixel, where OpenGL 4.0 can.
inline void shade_samples(bool on) {
  if (epoxy_gl_version() < 40) return;
  on ? glEnable(GL_SAMPLE_SHADING) : glDisable(GL_SAMPLE_SHADING);
  if (on) glMinSampleShading(1.0F);
}

inline void enable_multisampling() { glEnable(GL_MULTISAMPLE); }

/// Waits until all drawing is complete.
inline void finish_drawing() { glFinish(); }

#endif

}  // namespace palpate::render
