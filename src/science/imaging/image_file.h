#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate::imaging {

/// A photograph, row by row from the top.
struct Picture {
  int width = 0;  // pixels
  int height = 0;
  std::vector<float> gray;        // 0 black .. 1 white, one a pixel
  std::vector<std::uint8_t> rgb;  // three a pixel
};

inline constexpr int kSmallestPicture = 64;              // pixels, either side
inline constexpr std::int64_t kMostPixels = 50'000'000;  // of a picture

/// [setup] Reads a PNG or JPEG file, told apart by its first bytes. Its size is checked before its pixels are
/// decoded. Transparent parts lie on white.
/// @throws InputError naming the file: it cannot be read, is neither, is cut off, or is smaller than
/// kSmallestPicture or larger than kMostPixels.
[[nodiscard]] Picture read_picture(const std::filesystem::path& file);

}  // namespace palpate::imaging
