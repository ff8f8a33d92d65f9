#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate::imaging {

/// A photograph, by rows from the top.
struct Picture {
  int width = 0;  // pixels
  int height = 0;
  std::vector<float> gray;        // 0 black .. 1 white, one per pixel
  std::vector<std::uint8_t> rgb;  // three per pixel
};

inline constexpr int kSmallestPicture = 64;             // pixels, each side
inline constexpr std::int64_t kMaxPixels = 50'000'000;  // per picture

/// [setup] Reads a PNG or JPEG file; the first bytes decide which. The size is checked before the pixels are
/// decoded. Transparent parts are blended with white.
/// @throws InputError that names the file. Causes: it cannot be read, is neither format, is truncated, or is
/// smaller than kSmallestPicture or larger than kMaxPixels.
[[nodiscard]] Picture read_picture(const std::filesystem::path& file);

}  // namespace palpate::imaging
