// A browser's contexts belong to canvases: a picture is drawn in the one that is current
// (OffscreenRenderer::InCurrentContext).
#include "view/render/gl_context.h"

#include <stdexcept>

namespace palpate::render {

GlContext::GlContext() { throw std::runtime_error("no picture can be drawn without a canvas"); }

GlContext::~GlContext() = default;

void GlContext::make_current() {}

void GlContext::release() noexcept {}

}  // namespace palpate::render
