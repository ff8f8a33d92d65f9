// Pictures, in a program without OpenGL.
#include "palpate/error.h"
#include "palpate/offscreen.h"

namespace palpate::render {

void write_png(const Image& /*image*/, const std::filesystem::path& file) {
  throw InputError(file.string() + ": palpate for Windows draws no pictures");
}

}  // namespace palpate::render
