#include "app/window/viewer.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include <epoxy/gl.h>
#include <fmt/core.h>
#include <imgui.h>

#include "io/system/clock.h"
#include "view/render/map_legend.h"

#include "app/messages.h"
#include "app/session.h"
#include "app/window/panels.h"

namespace palpate::app {
namespace {

constexpr std::int64_t kViewerFrameNs = 16'000'000;  // at most 62 frames per second
constexpr std::int64_t kStillAfterNs =
    250'000'000;                       // without motion, before the picture is drawn at full quality
constexpr double kLongestFrame = 0.1;  // s, longest playback step of a frame
constexpr double kPlotted = 8.0;       // s

}  // namespace

OpenRecording::OpenRecording(const std::filesystem::path& file, bool no_cache)
    : OpenRecording(std::make_unique<RecordedView>(file, no_cache)) {}

OpenRecording::OpenRecording(std::unique_ptr<RecordedView> seen)
    : view(std::move(seen)), overview(overview_of(*view)) {
  for (std::uint32_t hand = 0; hand < view->hands(); ++hand) {
    whole.push_back(view->camera(hand, false));
    close_up.push_back(view->camera(hand, true));
  }
}

Viewer::Viewer(std::unique_ptr<RecordedView> seen, const ViewerOptions& options)
    : options_(options), viewport_("Palpate", options_.size, options_.scale) {
  state_.close_up = options_.close_up;
  state_.drape = options_.drape;
  if (options_.map_range > 0.0) {
    state_.map = true;
    state_.map_range = options_.map_range;
  }
  show(std::make_unique<OpenRecording>(std::move(seen)));
  if (options_.at_s) playback_->go_to(view().tick_at(*options_.at_s));
}

Viewer::~Viewer() {
  ticks_.reset();
  if (!viewport_.display().lost()) return;
  live_.abandon();
  (void)still_.release();
}

void Viewer::show(std::unique_ptr<OpenRecording> open) {
  ticks_.reset();
  open_ = std::move(open);
  const scene::Scene& scene = view().recording().scene;
  playback_.emplace(view().ticks(), scene.rate_Hz);
  state_.hand = 0;
  snapshot_there_ = false;
  there_ = false;
  still_.reset();
  stills_fit_ = true;
  live_knows_ = false;
  camera_.look_exactly_as(first_camera());
  rows_.assign(view().hands(), {});
  ticks_plotted_ = {1, 0};
  ticks_ = std::make_unique<ReplayThread>(open_->view->frames());
  viewport_.display().set_title("Palpate: " + view().file().filename().string());
}

const render::Camera& Viewer::first_camera() const {
  return (state_.close_up ? open_->close_up : open_->whole)[state_.hand];
}

void Viewer::begin_to_open(const std::filesystem::path& file) {
  if (next_.valid()) {
    viewport_.show_message("another recording is being opened already");
    return;
  }
  next_name_ = file.filename().string();
  next_ = std::async(std::launch::async, [file, no_cache = options_.no_cache] {
    return std::make_unique<OpenRecording>(file, no_cache);
  });
}

void Viewer::poll_opening() {
  if (!next_.valid() || next_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    show(next_.get());
  } catch (const std::exception& error) {
    viewport_.show_message(error.what());
  }
}

bool Viewer::frame() {
  const std::int64_t before = frame_began_ns_;
  frame_began_ns_ = monotonic_ns();
  leaving_ |= viewport_.take_events(
      options_.stop, [this](const SDL_Event& event, std::pair<int, int> way) { take_event(event, way); });
  poll_opening();
  if (leaving_) return false;
  // Playback waits until the requested tick is reached, so that a slow machine skips nothing.
  const double passed = before == 0 ? 0.0 : 1e-9 * static_cast<double>(frame_began_ns_ - before);
  if (there_) playback_->advance(std::min(passed, kLongestFrame));
  ticks_->want(playback_->tick());
  go_on();
  compose();
  draw_picture();
  Viewport::draw_panels();
  if (commands_.save_window) viewport_.save(viewport_.picture());
  glFinish();
  if (Viewport::out_of_memory()) save_memory();
  if (viewport_.graphics_lost()) viewport_.display().give_up();
  live_.adapt(1e-9 * static_cast<double>(monotonic_ns() - frame_began_ns_));
  viewport_.show();
  grant(std::exchange(commands_, {}));
  sleep_until_ns(frame_began_ns_ + kViewerFrameNs);
  return true;
}

/// Frees graphics memory after it ran out.
void Viewer::save_memory() {
  if (still_ != nullptr) {
    still_.reset();
    stills_fit_ = false;
    viewport_.show_message("the graphics card's memory ran out: pictures at rest are as when they move");
  } else if (live_.shrink()) {
    viewport_.show_message("the graphics card's memory ran out: the picture is coarser");
  }
}

/// Takes the latest snapshot of the replay.
void Viewer::go_on() {
  there_ = ticks_->there();
  if (!ticks_->take(shown_)) return;
  snapshot_there_ = true;
  moved_ns_ = frame_began_ns_;
  active_parameters_ = active_parameters(view().recording(), shown_.tick);
  live_.refresh();
}

/// Copies the rows of the plotted time, 8 s around the shown tick.
void Viewer::gather_rows() {
  const double whole = view().duration_s();
  const double from =
      std::clamp(view().time_of(shown_.tick) - 0.5 * kPlotted, 0.0, std::max(0.0, whole - kPlotted));
  const std::pair wanted{view().tick_at(from), view().tick_at(std::min(whole, from + kPlotted))};
  if (wanted == ticks_plotted_) return;
  ticks_plotted_ = wanted;
  for (std::uint32_t hand = 0; hand < view().hands(); ++hand) {
    rows_[hand].clear();
    for (std::uint64_t tick = wanted.first; tick <= wanted.second; ++tick) {
      rows_[hand].push_back(view().row(tick, hand));
    }
  }
}

void Viewer::compose() {
  viewport_.begin_panels();
  const ImGuiIO& io = ImGui::GetIO();
  layout_ = lay_out(io.DisplaySize.x, io.DisplaySize.y, viewport_.scale(), state_);
  if (snapshot_there_) {
    gather_rows();
    const double from = view().time_of(ticks_plotted_.first);
    const double to = std::max(from + 1e-3, view().time_of(ticks_plotted_.second + 1));
    const ViewerModel seen{view(), overview(), *playback_, shown_.tick, active_parameters_,
                           rows_,  from,       to,         there_,      still_shown_};
    if (layout_.left.width > 0.0F) draw_viewer_panels(layout_.left, seen, state_, commands_);
    if (layout_.timeline.height > 0.0F) draw_timeline(layout_.timeline, seen, state_, commands_);
    if (layout_.plots.height > 0.0F) {
      const scene::Scene& scene = view().recording().scene;
      const bool pull = scene.task == scene::Task::kPull;
      Plotted plots{active_parameters_.tissue, pull ? model::Direction::kPull : model::Direction::kPress,
                    scene.rate_Hz};
      for (std::uint32_t hand = 0; hand < view().hands(); ++hand) {
        plots.hands.push_back({rows_[hand], view().row(shown_.tick, hand)});
      }
      plots.strong = state_.hand;
      plots.from = from;
      plots.to = to;
      plots.cursor = view().time_of(shown_.tick);
      draw_plots(layout_.plots, plots);
    }
  }
  draw_overlay();
  draw_viewer_help(state_);
  if (const std::optional<ChosenFile> file = state_.files.draw()) commands_.open = file->path.string();
  Viewport::end_panels();
}

std::string Viewer::banner_text() const {
  std::string failure = ticks_->failure();
  if (!failure.empty()) return failure;
  for (std::uint32_t hand = 0; snapshot_there_ && hand < view().hands(); ++hand) {
    const auto fault = static_cast<haptics::Fault>(view().row(shown_.tick, hand).fault);
    if (fault == haptics::Fault::kNone) continue;
    const std::string whose = view().hands() > 1 ? fmt::format("Hand {}: zero force", hand) : "Zero force";
    return whose + ": " + haptics::describe(fault);
  }
  return {};
}

/// Draws title, banner, colour scale and message over the picture.
void Viewer::draw_overlay() {
  banner_ = banner_text();
  std::vector<Banner> banners = {{banner_, true}};
  if (next_.valid()) banners.push_back({next_name_ + " is being opened ..."});
  const float y = viewport_.draw_overlay(layout_.picture, banners,
                                         title_of(view().recording().scene) +
                                             formatted("   %.3f s", view().time_of(shown_.tick)) +
                                             formatted(" of %.3f s", view().duration_s()));
  if (state_.map) draw_map_scale(layout_.picture, y + 1.2F * ImGui::GetFontSize(), state_.map_range);
}

void Viewer::draw_picture() {
  viewport_.clear();
  still_shown_ = false;
  const PixelRectangle place = in_pixels(layout_.picture, viewport_);
  if (!snapshot_there_ || place.width < 1 || place.height < 1) return;
  if (!std::exchange(live_knows_, true)) live_.take(view().subject());
  const render::Camera camera = camera_.camera();
  const double map = state_.map ? state_.map_range : 0.0;
  live_.set_map_range(map);
  live_.show_drape(state_.drape);
  if (camera != last_camera_) moved_ns_ = frame_began_ns_;
  last_camera_ = camera;
  const bool quiet = stills_fit_ && there_ && !playback_->playing() &&
                     frame_began_ns_ - moved_ns_ > kStillAfterNs && !ImGui::IsAnyItemActive() &&
                     !camera_controller_.busy();
  if (quiet) {
    draw_still(place, camera);
  } else {
    live_.show(shown_, camera, layout_.picture, viewport_);
  }
}

/// Draws the picture bit for bit as `palpate view --screenshot`, with a renderer that has drawn nothing else.
void Viewer::draw_still(const PixelRectangle& place, const render::Camera& camera) {
  const double map = state_.map ? state_.map_range : 0.0;
  const bool same_moment = still_ != nullptr && still_tick_ == shown_.tick;
  const Display::Size size{std::clamp(place.width, 1, render::kLargestSide),
                           std::clamp(place.height, 1, render::kLargestSide)};
  const bool same_size = still_size_.width == size.width && still_size_.height == size.height;
  if (!same_moment) {
    still_.reset();
    still_ = std::make_unique<render::OffscreenRenderer>(view().subject(), size.width, size.height,
                                                         render::OffscreenRenderer::InCurrentContext{},
                                                         render::Quality::kFull);
    still_tick_ = shown_.tick;
  } else if (!same_size) {
    still_->resize(size.width, size.height);
  }
  if (!same_moment || !same_size || map != still_map_ || state_.drape != still_drape_ ||
      camera != still_camera_) {
    still_size_ = size;
    still_map_ = map;
    still_drape_ = state_.drape;
    still_camera_ = camera;
    still_->set_map_range(map);
    still_->show_drape(state_.drape);
    still_->draw_and_keep(shown_, camera);
  }
  still_->show_at(place.x, place.y, place.width, place.height);
  const Display::Size pixels = viewport_.pixels();
  glViewport(0, 0, pixels.width, pixels.height);
  still_shown_ = true;
}

render::Image Viewer::still_picture() {
  draw_still(in_pixels(layout_.picture, viewport_), camera_.camera());
  render::Image image = still_->kept();
  render::draw_map_legend(image, still_map_);
  return image;
}

void view_in_window(std::unique_ptr<RecordedView> seen, const ViewerOptions& options) {
  try {
    Viewer viewer(std::move(seen), options);
    while (viewer.frame()) {
    }
  } catch (const DisplayLost& lost) {
    report_message(std::string(lost.what()) + ": the viewer ends");
  }
}

}  // namespace palpate::app
