#include <string>

#include <fmt/core.h>
#include <png.h>

#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/offscreen.h"

namespace palpate::render {

void write_png(const Image& image, const std::filesystem::path& file) {
  const std::size_t bytes =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
  if (image.width <= 0 || image.height <= 0 || image.rgb.size() != bytes)
    throw InputError(fmt::format(
        "{}: a picture of {} x {} pixels with {} bytes cannot be written; want width x height x 3 bytes",
        file.string(), image.width, image.height, image.rgb.size()));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  // png_image_write_to_file() would delete a device file that it cannot write to.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string encoded(size, '\0');
  if (png_image_write_to_memory(&header, encoded.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string why = header.message;
    png_image_free(&header);
    throw InputError(file.string() + ": the picture cannot be written: " + why);
  }
  encoded.resize(size);
  write_output(file, encoded);
}

}  // namespace palpate::render
