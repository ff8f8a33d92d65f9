#include "fit/imaging/image_file.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>  // must precede jpeglib.h
#include <span>
#include <string>

#include <fmt/core.h>
#include <jpeglib.h>
#include <png.h>

#include "io/system/file_content.h"
#include "io/system/input_file.h"
#include "palpate/error.h"

namespace palpate::imaging {
namespace {

using Bytes = std::vector<unsigned char>;

Bytes read_bytes(const std::filesystem::path& file) {
  const std::string bytes = InputFile(file, kPictureInput).read_rest();
  return {bytes.begin(), bytes.end()};
}

void check_size(const std::filesystem::path& file, std::int64_t width, std::int64_t height) {
  const std::string size = fmt::format("{} x {} pixels", width, height);
  if (width < kSmallestPicture || height < kSmallestPicture) {
    throw InputError(
        fmt::format("{}: is {}, must be at least {} either way", file.string(), size, kSmallestPicture));
  }
  if (width > kMaxPixels / height) {
    throw InputError(fmt::format("{}: is {}, must have at most {} pixels", file.string(), size, kMaxPixels));
  }
}

Picture sized(std::int64_t width, std::int64_t height) {
  Picture picture;
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  picture.rgb.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  return picture;
}

Picture read_png(const std::filesystem::path& file, const Bytes& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto fail = [&file, &header] {
    const std::string why = header.message;
    png_image_free(&header);
    throw InputError(file.string() + ": is no whole PNG picture: " + why);
  };
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0) fail();
  try {
    check_size(file, header.width, header.height);
  } catch (const InputError&) {
    png_image_free(&header);
    throw;
  }
  Picture picture = sized(header.width, header.height);
  header.format = PNG_FORMAT_RGB;
  const png_color white = {255, 255, 255};
  if (png_image_finish_read(&header, &white, picture.rgb.data(), 0, nullptr) == 0) fail();
  return picture;
}

/// Error handling of libjpeg: longjmp to where decoding began.
struct JpegError {
  jpeg_error_mgr manager{};  // first member, so that libjpeg's pointer to it points to the whole
  std::jmp_buf back{};
  char why[JMSG_LENGTH_MAX] = {};
};

[[noreturn]] void leave(j_common_ptr jpeg) {
  auto* error = reinterpret_cast<JpegError*>(jpeg->err);
  error->manager.format_message(jpeg, error->why);
  std::longjmp(error->back, 1);
}

void count_warning(j_common_ptr jpeg, int level) {
  if (level < 0) ++jpeg->err->num_warnings;
}

/// Decodes into `rgb` after `checked` has accepted the size; false, with the reason in `error`, on failure.
/// No object with a destructor may live here, because longjmp would skip it.
bool decode_jpeg(std::span<const unsigned char> bytes, jpeg_decompress_struct& jpeg, JpegError& error,
                 Picture& picture, bool header_only) {
  if (setjmp(error.back) != 0) return false;
  if (header_only) {
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    return true;
  }
  jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&jpeg);
  const std::size_t stride = static_cast<std::size_t>(picture.width) * 3;
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = picture.rgb.data() + jpeg.output_scanline * stride;
    jpeg_read_scanlines(&jpeg, &row, 1);
    if (error.manager.num_warnings > 0) error.manager.error_exit(reinterpret_cast<j_common_ptr>(&jpeg));
  }
  return true;
}

Picture read_jpeg(const std::filesystem::path& file, const Bytes& bytes) {
  JpegError error;
  jpeg_decompress_struct jpeg{};
  jpeg.err = jpeg_std_error(&error.manager);
  error.manager.error_exit = leave;
  error.manager.emit_message = count_warning;
  Picture picture;
  bool whole = decode_jpeg(bytes, jpeg, error, picture, true);
  try {
    if (whole) {
      check_size(file, jpeg.image_width, jpeg.image_height);
      picture = sized(jpeg.image_width, jpeg.image_height);
      whole = decode_jpeg(bytes, jpeg, error, picture, false);
    }
  } catch (const InputError&) {
    jpeg_destroy_decompress(&jpeg);
    throw;
  }
  jpeg_destroy_decompress(&jpeg);
  if (!whole) throw InputError(file.string() + ": is no whole JPEG picture: " + error.why);
  return picture;
}

bool begins_with(const Bytes& bytes, std::span<const unsigned char> wanted) {
  if (bytes.size() < wanted.size()) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (bytes[i] != wanted[i]) return false;
  }
  return true;
}

}  // namespace

Picture read_picture(const std::filesystem::path& file) {
  constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G'};
  constexpr unsigned char kJpeg[] = {0xff, 0xd8, 0xff};
  const Bytes bytes = read_bytes(file);
  Picture picture;
  if (begins_with(bytes, kPng)) {
    picture = read_png(file, bytes);
  } else if (begins_with(bytes, kJpeg)) {
    picture = read_jpeg(file, bytes);
  } else {
    refuse_other_content(file, FileContent::kOther, "a PNG or JPEG picture");
    throw InputError(file.string() + ": is no picture this program reads, must be a PNG or JPEG file");
  }
  const std::size_t pixels = picture.rgb.size() / 3;
  picture.gray.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {  // luma of Rec. 601, as in JPEG
    const std::uint8_t* rgb = picture.rgb.data() + 3 * i;
    picture.gray[i] = (0.299F * static_cast<float>(rgb[0]) + 0.587F * static_cast<float>(rgb[1]) +
                       0.114F * static_cast<float>(rgb[2])) /
                      255.0F;
  }
  return picture;
}

}  // namespace palpate::imaging
