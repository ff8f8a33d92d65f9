#pragma once
#include <limits>

#include <Eigen/Core>

namespace palpate::render {

/// A rectangle of a picture [pixels from the lower left corner] or of the shadow map [entries].
struct ScreenBox {
  float left = std::numeric_limits<float>::infinity();
  float low = std::numeric_limits<float>::infinity();
  float right = -std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  [[nodiscard]] bool empty() const noexcept { return !(left <= right && low <= high); }
  void add(const Eigen::Vector2f& point) noexcept;
  void add(const ScreenBox& other) noexcept;
  [[nodiscard]] bool touches(const ScreenBox& other) const noexcept {
    return left <= other.right && other.left <= right && low <= other.high && other.low <= high;
  }
};

/// Whole pixels of a picture; right and top are the first ones outside.
struct PixelBox {
  int left = 0;
  int low = 0;
  int right = 0;
  int high = 0;

  bool operator==(const PixelBox& other) const = default;
  [[nodiscard]] bool empty() const noexcept { return left >= right || low >= high; }
  /// Larger by these numbers of pixels on each side, within a picture of this size.
  [[nodiscard]] PixelBox grown(int x, int y, int width, int height) const noexcept;
};

/// [any] The pixels of a picture of this size that something drawn in a box can cover: one more on each side
/// than computed here in single precision.
[[nodiscard]] PixelBox pixels_of(const ScreenBox& box, int width, int height) noexcept;

}  // namespace palpate::render
