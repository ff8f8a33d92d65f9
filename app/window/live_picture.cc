#include "app/window/live_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <epoxy/gl.h>

namespace palpate::app {

PixelRectangle in_pixels(const Rectangle& place, const Viewport& viewport) {
  const double ratio = viewport.enlarged();
  const auto rounded = [ratio](float length) { return static_cast<int>(std::lround(ratio * length)); };
  const int height = rounded(place.height);
  return {rounded(place.x), viewport.pixels().height - rounded(place.y) - height, rounded(place.width),
          height};
}

void LivePicture::take(const render::Subject& subject) {
  renderer_.reset();       // frees its memory before the new renderer allocates
  drawn_size_ = {60, 44};  // not powers of two, for which Mesa's software renderer has separate shaders
  renderer_ = std::make_unique<render::OffscreenRenderer>(subject, drawn_size_.width, drawn_size_.height,
                                                          render::OffscreenRenderer::InCurrentContext{});
  renderer_->show_at(0, 0, 96, 96);  // drivers prepare scaled copies at the first one
  if (held_) renderer_->hold_quality(render::Quality::kFull);
  if (!resolution_.all()) renderer_->limit_quality(render::Quality::kFast);
  renderer_->set_map_range(map_range_);
  renderer_->show_drape(drape_);
  values_ = 0;
  stale_ = true;
}

void LivePicture::hold_full_quality() {
  resolution_.raise_to_all();
  held_ = true;
  renderer_->hold_quality(render::Quality::kFull);
}

void LivePicture::set_map_range(double range) {
  if (range == map_range_) return;
  map_range_ = range;
  renderer_->set_map_range(range);
  stale_ = true;
}

void LivePicture::show_drape(bool shown) {
  if (shown == drape_) return;
  drape_ = shown;
  renderer_->show_drape(shown);
  stale_ = true;
}

void LivePicture::show_inclusions(std::vector<model::Inclusion> inclusions) {
  renderer_->show_inclusions(std::move(inclusions));
  stale_ = true;
}

void LivePicture::show_values(const std::vector<Vec3>& points_S, std::vector<float> values, double low,
                              double high) {
  if (points_S.empty() && values_ == 0) return;
  if (!points_S.empty() && values_ == points_S.size() && low == low_ && high == high_) {
    renderer_->update_values(values);
  } else {
    renderer_->show_values({points_S, std::move(values), low, high});
  }
  values_ = points_S.size();
  low_ = low;
  high_ = high;
  stale_ = true;
}

void LivePicture::set_support(std::optional<geometry::Support> support) {
  renderer_->set_support(std::move(support));
  stale_ = true;
}

render::ResponseState LivePicture::response() const noexcept {
  return renderer_ == nullptr ? render::ResponseState::kNone : renderer_->response();
}

void LivePicture::show_marks(const std::vector<render::SurfaceMark>& marks) {
  renderer_->show_marks(marks);
  stale_ = true;
}

void LivePicture::show(const haptics::Snapshot& snapshot, const render::Camera& camera,
                       const Rectangle& place, const Viewport& viewport) {
  const PixelRectangle there = in_pixels(place, viewport);
  if (there.width < 1 || there.height < 1) return;
  fit(there.width, there.height);
  if (stale_ || camera != drawn_camera_) {
    renderer_->draw_and_keep(snapshot, camera);
    drew_ = true;
    drawn_camera_ = camera;
    stale_ = false;
  }
  renderer_->show_at(there.x, there.y, there.width, there.height);
  const Display::Size pixels = viewport.pixels();
  glViewport(0, 0, pixels.width, pixels.height);
}

/// Sizes the renderer's pictures: the shown size, or a smaller one if that takes too long.
void LivePicture::fit(int width, int height) {
  const auto drawn = [this](int side) {
    return std::clamp(static_cast<int>(std::lround(resolution_.now() * side)), 1, render::kLargestSide);
  };
  if (drawn(width) == drawn_size_.width && drawn(height) == drawn_size_.height) return;
  drawn_size_ = {drawn(width), drawn(height)};
  renderer_->resize(drawn_size_.width, drawn_size_.height);
  stale_ = true;
}

void LivePicture::adapt(double frame_time) { (void)follow(frame_time, ResolutionChoice::kUsual); }

bool LivePicture::settle(double frame_time) {
  stale_ = true;
  return follow(frame_time, ResolutionChoice::kFew);
}

/// Chooses quality and resolution. The resolution falls after the renderer's quality and rises before it.
bool LivePicture::follow(double frame_time, std::size_t judged) {
  if (held_) return true;
  if (!std::exchange(drew_, false)) return false;
  const bool may_cheapen = renderer_->quality() != render::Quality::kFast;
  const bool fits = resolution_.add(frame_time, may_cheapen, judged);
  renderer_->limit_quality(resolution_.all() ? render::Quality::kBalanced : render::Quality::kFast);
  return fits;
}

bool LivePicture::shrink() {
  if (!resolution_.lower()) return false;
  stale_ = true;
  return true;
}

}  // namespace palpate::app
