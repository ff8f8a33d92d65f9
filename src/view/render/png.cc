#include <cerrno>
#include <cstring>

#include <fmt/core.h>
#include <png.h>

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
  errno = 0;
  if (png_image_write_to_file(&header, file.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string why = errno != 0 ? std::strerror(errno) : header.message;
    png_image_free(&header);
    throw InputError(file.string() + ": the picture cannot be written: " + why);
  }
}

}  // namespace palpate::render
