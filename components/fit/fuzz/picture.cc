// Photographs as PNG or JPEG: read within the limits on size, or rejected.
#include "fit/imaging/image_file.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".png");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    const imaging::Picture picture = imaging::read_picture(file);
    const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    fuzz::require(pixels <= static_cast<std::size_t>(imaging::kMaxPixels), "a picture is within the limit");
    fuzz::require(picture.gray.size() == pixels && picture.rgb.size() == 3 * pixels, "a picture is whole");
    for (const float gray : picture.gray) fuzz::require(gray >= 0.0F && gray <= 1.001F, "gray is a share");
  });
  return 0;
}
