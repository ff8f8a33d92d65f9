#pragma once
#include <cstddef>
#include <limits>
#include <vector>

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

/// The part of a picture to draw again, in square tiles.
class ChangedTiles final {
 public:
  static constexpr int kTile = 32;  // pixels

  /// [setup] No tile of a picture of this size [pixels].
  ChangedTiles(int width, int height);
  /// [any] Adds the tiles with pixels that something drawn in a box can cover.
  void add(const ScreenBox& box) noexcept;
  /// [any] Adds all tiles.
  void add_all() noexcept;

  [[nodiscard]] bool empty() const noexcept { return bounds_.empty(); }
  [[nodiscard]] bool all() const noexcept { return added_ == tiles_.size(); }
  /// [any] The smallest rectangle of pixels around all tiles.
  [[nodiscard]] PixelBox bounds() const noexcept { return bounds_; }
  /// [any] Whether something drawn in a box can cover pixels in these tiles.
  [[nodiscard]] bool touch(const ScreenBox& box) const noexcept;
  /// [setup] Rectangles of pixels that cover the tiles, each pixel once.
  [[nodiscard]] std::vector<PixelBox> rectangles() const;

 private:
  // Columns and rows of tiles; right and high are the first ones outside.
  [[nodiscard]] PixelBox tiles_of(const ScreenBox& box) const noexcept;
  [[nodiscard]] std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row * columns_ + column);
  }
  // End of the run of added tiles that begins in a column of a row.
  [[nodiscard]] int run_end(const std::vector<char>& tiles, int column, int row) const noexcept;

  int width_;
  int height_;
  int columns_;
  int rows_;
  std::vector<char> tiles_;
  std::size_t added_ = 0;
  PixelBox bounds_;
};

}  // namespace palpate::render
