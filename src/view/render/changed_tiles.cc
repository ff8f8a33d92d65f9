#include "view/render/changed_tiles.h"

#include <algorithm>
#include <cmath>

namespace palpate::render {
namespace {

constexpr float kPixelMargin = 1.0F;  // pixels: more than single precision is off by

int clamped(float value, int last) {
  return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(last)));
}

}  // namespace

ChangedTiles::ChangedTiles(int width, int height)
    : width_(width),
      height_(height),
      columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      tiles_(static_cast<std::size_t>(columns_ * rows_), 0) {}

PixelBox ChangedTiles::tiles_of(const ScreenBox& box) const noexcept {
  const PixelBox pixels = pixels_of(box, width_, height_);
  if (pixels.empty()) return {};
  return {pixels.left / kTile, pixels.low / kTile, (pixels.right - 1) / kTile + 1,
          (pixels.high - 1) / kTile + 1};
}

void ChangedTiles::add(const ScreenBox& box) noexcept {
  const PixelBox tiles = tiles_of(box);
  if (tiles.empty()) return;
  for (int row = tiles.low; row < tiles.high; ++row) {
    for (int column = tiles.left; column < tiles.right; ++column) {
      char& tile = tiles_[index(column, row)];
      added_ += tile == 0 ? 1 : 0;
      tile = 1;
    }
  }
  const PixelBox pixels{tiles.left * kTile, tiles.low * kTile, std::min(tiles.right * kTile, width_),
                        std::min(tiles.high * kTile, height_)};
  bounds_ = bounds_.empty()
                ? pixels
                : PixelBox{std::min(bounds_.left, pixels.left), std::min(bounds_.low, pixels.low),
                           std::max(bounds_.right, pixels.right), std::max(bounds_.high, pixels.high)};
}

void ChangedTiles::add_all() noexcept {
  std::fill(tiles_.begin(), tiles_.end(), 1);
  added_ = tiles_.size();
  bounds_ = {0, 0, width_, height_};
}

bool ChangedTiles::touch(const ScreenBox& box) const noexcept {
  const PixelBox tiles = tiles_of(box);
  for (int row = tiles.low; row < tiles.high; ++row)
    for (int column = tiles.left; column < tiles.right; ++column)
      if (tiles_[index(column, row)] != 0) return true;
  return false;
}

int ChangedTiles::run_end(const std::vector<char>& tiles, int column, int row) const noexcept {
  while (column < columns_ && tiles[index(column, row)] != 0) ++column;
  return column;
}

std::vector<PixelBox> ChangedTiles::rectangles() const {
  std::vector<PixelBox> rectangles;
  std::vector<char> left = tiles_;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const int end = run_end(left, column, row);
      if (end == column) continue;
      // The run, and the rows above with the same run.
      int high = row;
      while (high < rows_ && (column == 0 || left[index(column - 1, high)] == 0) &&
             run_end(left, column, high) == end) {
        std::fill_n(left.begin() + static_cast<std::ptrdiff_t>(index(column, high)), end - column, 0);
        ++high;
      }
      rectangles.push_back(
          {column * kTile, row * kTile, std::min(end * kTile, width_), std::min(high * kTile, height_)});
      column = end;
    }
  }
  return rectangles;
}

void ScreenBox::add(const Eigen::Vector2f& point) noexcept {
  left = std::min(left, point.x());
  low = std::min(low, point.y());
  right = std::max(right, point.x());
  high = std::max(high, point.y());
}

void ScreenBox::add(const ScreenBox& other) noexcept {
  left = std::min(left, other.left);
  low = std::min(low, other.low);
  right = std::max(right, other.right);
  high = std::max(high, other.high);
}

PixelBox PixelBox::grown(int x, int y, int width, int height) const noexcept {
  if (empty()) return *this;
  return {std::max(left - x, 0), std::max(low - y, 0), std::min(right + x, width),
          std::min(high + y, height)};
}

PixelBox pixels_of(const ScreenBox& box, int width, int height) noexcept {
  if (box.empty()) return {};
  return {clamped(std::floor(box.left - kPixelMargin), width),
          clamped(std::floor(box.low - kPixelMargin), height),
          clamped(std::ceil(box.right + kPixelMargin), width),
          clamped(std::ceil(box.high + kPixelMargin), height)};
}

}  // namespace palpate::render
