#include "view/render/screen_box.h"

#include <algorithm>
#include <cmath>

namespace palpate::render {
namespace {

constexpr float kPixelMargin = 1.0F;  // pixels: more than single precision is off by

int clamped(float value, int last) {
  return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(last)));
}

}  // namespace

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
