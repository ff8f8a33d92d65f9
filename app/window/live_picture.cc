#include "app/window/live_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <epoxy/gl.h>

namespace palpate::app {
namespace {

constexpr double kBudget = 33e-3;         // s, of a frame: what the picture's resolution adapts to
constexpr double kFastEnough = 14e-3;     // s: below it the resolution may rise
constexpr std::size_t kFramesJudged = 8;  // one after the other
constexpr std::array<double, 5> kResolutions = {1.0, 0.8, 0.65, 0.5,
                                                0.4};  // pixels drawn a pixel shown, a side
constexpr int kLargestSide = 8192;                     // of a picture, as OffscreenRenderer has it

}  // namespace

bool same(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.vertical_view_deg == b.vertical_view_deg;
}

PixelRectangle in_pixels(const Rectangle& place, const Stage& stage) {
  const double ratio = stage.enlarged();
  const auto rounded = [ratio](float length) { return static_cast<int>(std::lround(ratio * length)); };
  const int height = rounded(place.height);
  return {rounded(place.x), stage.pixels().height - rounded(place.y) - height, rounded(place.width), height};
}

void LivePicture::take(const render::Subject& subject) {
  renderer_.reset();  // the old one's memory goes before the new one's comes
  drawn_size_ = {64, 64};
  renderer_ = std::make_unique<render::OffscreenRenderer>(subject, drawn_size_.width, drawn_size_.height,
                                                          render::OffscreenRenderer::InCurrentContext{});
  if (held_) renderer_->hold_quality(render::Quality::kFull);
  renderer_->set_map_range(map_range_);
  stale_ = true;
}

void LivePicture::hold_full_quality() {
  resolution_ = 0;
  held_ = true;
  renderer_->hold_quality(render::Quality::kFull);
}

void LivePicture::set_map_range(double range) {
  if (range == map_range_) return;
  map_range_ = range;
  renderer_->set_map_range(range);
  stale_ = true;
}

bool LivePicture::show(const haptics::Snapshot& snapshot, const render::Camera& camera,
                       const Rectangle& place, const Stage& stage) {
  drew_ = false;
  const PixelRectangle there = in_pixels(place, stage);
  if (there.width < 1 || there.height < 1) return false;
  fit(there.width, there.height);
  if (stale_ || !same(camera, drawn_camera_)) {
    renderer_->draw_and_keep(snapshot, camera);
    drew_ = true;
    drawn_camera_ = camera;
    stale_ = false;
  }
  renderer_->show_at(there.x, there.y, there.width, there.height);
  const Display::Size pixels = stage.pixels();
  glViewport(0, 0, pixels.width, pixels.height);
  return drew_;
}

/// The renderer's pictures are as large as the picture is shown, or smaller where that takes too long.
void LivePicture::fit(int width, int height) {
  const auto drawn = [this](int side) {
    return std::clamp(static_cast<int>(std::lround(kResolutions[resolution_] * side)), 1, kLargestSide);
  };
  if (drawn(width) == drawn_size_.width && drawn(height) == drawn_size_.height) return;
  drawn_size_ = {drawn(width), drawn(height)};
  renderer_->resize(drawn_size_.width, drawn_size_.height);
  stale_ = true;
}

/// The picture's resolution follows what the machine can draw in time, once the renderer itself has done what
/// it can.
void LivePicture::adapt(double frame_time) {
  if (!drew_) return;
  times_.push_back(frame_time);
  if (times_.size() < kFramesJudged) return;
  std::sort(times_.begin(), times_.end());
  const double usual = times_[times_.size() / 2];
  times_.clear();
  if (held_) return;
  const bool has_more = renderer_->quality() != render::Quality::kFast;
  if (usual > kBudget && has_more && usual < 3.0 * kBudget) return;
  if (usual > 3.0 * kBudget && resolution_ + 2 < kResolutions.size()) ++resolution_;
  if (usual > kBudget && resolution_ + 1 < kResolutions.size()) ++resolution_;
  if (usual < kFastEnough && resolution_ > 0) --resolution_;
}

bool LivePicture::shrink() {
  if (resolution_ + 1 >= kResolutions.size()) return false;
  ++resolution_;
  stale_ = true;
  return true;
}

}  // namespace palpate::app
