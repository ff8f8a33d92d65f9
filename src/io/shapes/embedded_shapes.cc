#include "io/shapes/embedded_shapes.h"

#include <zlib.h>

#include "io/shapes/mesh_archive.h"

// The assembler embeds the archive in the object file.
asm(R"(
  .pushsection .rodata
palpate_shapes: .incbin ")" PALPATE_SHAPES R"("
palpate_shapes_end:
  .popsection
)");
extern "C" {
[[gnu::visibility("hidden")]] extern const unsigned char palpate_shapes[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_shapes_end[];
}

namespace palpate::geometry {

std::span<const unsigned char> built_in_meshes() noexcept {
  return {static_cast<const unsigned char*>(palpate_shapes),
          static_cast<const unsigned char*>(palpate_shapes_end)};
}

bool inflate(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) noexcept {
  uLongf size = unpacked.size();
  return uncompress(unpacked.data(), &size, packed.data(), packed.size()) == Z_OK && size == unpacked.size();
}

}  // namespace palpate::geometry
