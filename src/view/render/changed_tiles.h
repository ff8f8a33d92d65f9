#pragma once
#include <cstddef>
#include <vector>

#include "view/render/screen_box.h"

namespace palpate::render {

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
