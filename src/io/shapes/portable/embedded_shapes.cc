#include "io/shapes/embedded_shapes.h"

#include "io/shapes/mesh_archive.h"

// stb_image's decoder of zlib streams alone.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace palpate::geometry {
namespace {

constexpr unsigned char kShapes[] = {
#include "shapes.inc"
};

}  // namespace

std::span<const unsigned char> built_in_meshes() noexcept { return kShapes; }

bool inflate(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) noexcept {
  const auto size = static_cast<int>(unpacked.size());
  return stbi_zlib_decode_buffer(reinterpret_cast<char*>(unpacked.data()), size,
                                 reinterpret_cast<const char*>(packed.data()),
                                 static_cast<int>(packed.size())) == size;
}

}  // namespace palpate::geometry
