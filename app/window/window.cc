#include "app/window/window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <thread>

#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include "palpate/base/clock.h"
#include "palpate/base/error.h"

#include "app/window/look.h"
#include "app/window/rows.h"

namespace palpate::app {
namespace {

constexpr double kBudget = 33e-3;         // s, of a frame: what the picture's resolution adapts to
constexpr double kFastEnough = 14e-3;     // s: below it the resolution may rise
constexpr std::size_t kFramesJudged = 8;  // one after the other
constexpr std::array<double, 5> kQualities = {1.0, 0.8, 0.65, 0.5,
                                              0.4};  // pixels drawn a pixel shown, a side
constexpr std::int64_t kFrameNs = 16'000'000;        // no more than 62 frames a second
constexpr std::int64_t kMessageNs = 8'000'000'000;
constexpr std::int64_t kAgesKeptNs = 3'000'000'000;
constexpr int kLargestSide = 8192;  // of a picture, as OffscreenRenderer has it

bool same(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.vertical_view_deg == b.vertical_view_deg;
}

std::string advice_on(haptics::Fault fault) {
  switch (fault) {
    case haptics::Fault::kNotFinite:
      return "Take the tool out of the tissue and reset; if it comes again, check the scene and the device.";
    case haptics::Fault::kDevice:
      return "Check the device's cable and power, then reset.";
    case haptics::Fault::kStale:
      return "Check the device's cable or service, close busy programs, then reset.";
    case haptics::Fault::kStalled:
      return "The computer was too busy: close other programs, then reset.";
    case haptics::Fault::kForceOff:
      return "Switch the force on at the device, then reset.";
    case haptics::Fault::kNone:
      break;
  }
  return {};
}

std::string state_words(const RowSample& row, const contact::ToolResult& result) {
  switch (result.phase) {
    case contact::Phase::kPress:
      return formatted("pressing, %.1f mm deep", 1e3 * row.depth);
    case contact::Phase::kPull:
      return formatted("pulling, stretched %.1f mm", 1e3 * row.depth);
    case contact::Phase::kApproach:
      break;
  }
  return formatted("%.1f mm from the tissue", 1e3 * row.distance);
}

}  // namespace

Window::Window(Session& first, scene::Request request, WindowOptions options)
    : request_(std::move(request)), options_(std::move(options)), display_("Palpate", options_.size) {
  start_imgui();
  SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);  // without it there are no gamepads, no more
  SDL_PumpEvents();
  begin(std::make_unique<LiveRun>(first, options_.recording, options_.core, options_.igtl));
}

Window::~Window() {
  if (run_ != nullptr) run_->stop();
  next_.reset();
  renderer_.reset();
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplSDL2_Shutdown();
  ImGui::DestroyContext();
  SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}

void Window::start_imgui() {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // nothing is written that nobody asked for
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  ImGui_ImplSDL2_InitForOpenGL(display_.window(), display_.context());
  ImGui_ImplOpenGL3_Init("#version 330 core");
  scale_ = display_.scale();
  const Display::Size units = display_.size();
  const float enlarged =
      units.width > 0 ? static_cast<float>(display_.pixels().width) / static_cast<float>(units.width) : 1.0F;
  set_look(scale_, std::max(1.0F, enlarged));
}

void Window::say(std::string message) {
  message_ = std::move(message);
  message_until_ns_ = monotonic_ns() + kMessageNs;
}

bool Window::frame() {
  frame_began_ns_ = monotonic_ns();
  take_events();
  look_after_runs();
  traces_->take(run_->rows(), !paused_);
  if (frame_began_ns_ > message_until_ns_) message_.clear();
  if (leaving_) return false;
  steering_.say(camera_);
  const Traces::Felt felt = traces_->take_felt();
  steering_.rumble(felt.tissue, felt.noise);

  drew_ = false;
  compose();
  take_newest();
  draw_picture();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (wishes_.screenshot) save_picture();
  glFinish();
  const Wishes wishes = std::exchange(wishes_, {});
  adapt(1e-9 * static_cast<double>(monotonic_ns() - frame_began_ns_));
  display_.swap();
  if (snapshot_there_ && !paused_ && !run_->ended()) {
    const std::int64_t now = monotonic_ns();
    all_ages_.add(now - shown_.taken_ns);
    age_ = 1e-9 * static_cast<double>(now - shown_.taken_ns);
    ages_.emplace_back(now, age_);
    while (ages_.front().first < now - kAgesKeptNs) ages_.pop_front();
  }
  grant(wishes);
  sleep_until_ns(frame_began_ns_ + kFrameNs);
  const double whole = 1e-9 * static_cast<double>(monotonic_ns() - frame_began_ns_);
  frames_a_second_ += 0.1 * (1.0 / whole - frames_a_second_);
  return true;
}

void Window::take_newest() {
  if (paused_ || !run_->snapshots().refresh()) return;
  shown_ = run_->snapshots().value();
  snapshot_there_ = true;
  picture_stale_ = true;
}

/// The picture's resolution follows what the machine can draw in time, once the renderer itself has done what
/// it can.
void Window::adapt(double frame_time) {
  frame_time_ = frame_time;
  if (!drew_) return;
  frame_times_.push_back(frame_time);
  if (frame_times_.size() < kFramesJudged) return;
  std::sort(frame_times_.begin(), frame_times_.end());
  const double usual = frame_times_[frame_times_.size() / 2];
  frame_times_.clear();
  if (quality_held_) return;
  const bool has_more = renderer_->quality() != render::Quality::kFast;
  if (usual > kBudget && has_more && usual < 3.0 * kBudget) return;
  if (usual > 3.0 * kBudget && quality_ + 2 < kQualities.size()) ++quality_;
  if (usual > kBudget && quality_ + 1 < kQualities.size()) ++quality_;
  if (usual < kFastEnough && quality_ > 0) --quality_;
}

void Window::hold_full_quality() {
  quality_ = 0;
  quality_held_ = true;
  renderer_->hold_quality(render::Quality::kFull);
}

void Window::draw_picture() {
  const Display::Size pixels = display_.pixels();
  const Display::Size units = display_.size();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, pixels.width, pixels.height);
  glClearColor(colour::kBackground.x, colour::kBackground.y, colour::kBackground.z, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  const double ratio = units.width > 0 ? static_cast<double>(pixels.width) / units.width : 1.0;
  const Rectangle& place = layout_.picture;
  const auto in_pixels = [ratio](float length) { return static_cast<int>(std::lround(ratio * length)); };
  const int width = in_pixels(place.width);
  const int height = in_pixels(place.height);
  if (!snapshot_there_ || width < 1 || height < 1) return;
  if (reach_changed_ && !ImGui::IsAnyItemActive()) make_renderer();
  if (!camera_set_) {
    const contact::ToolResult& result = shown_.results[0];
    camera_.look_as(render::frame_contact(subject(), shown_, result.nearest_W, result.normal_W, false),
                    static_cast<double>(width) / height);
    camera_set_ = true;
  }
  fit_renderer(width, height);
  const render::Camera camera = camera_.camera();
  if (picture_stale_ || !same(camera, drawn_camera_)) {
    renderer_->draw_and_keep(shown_, camera);
    drew_ = true;
    drawn_camera_ = camera;
    picture_stale_ = false;
  }
  renderer_->show_at(in_pixels(place.x), pixels.height - in_pixels(place.y) - height, width, height);
  glViewport(0, 0, pixels.width, pixels.height);
}

/// The renderer's pictures are as large as the picture is shown, or smaller where that takes too long.
void Window::fit_renderer(int width, int height) {
  const auto drawn = [this](int side) {
    return std::clamp(static_cast<int>(std::lround(kQualities[quality_] * side)), 1, kLargestSide);
  };
  if (drawn(width) == drawn_size_.width && drawn(height) == drawn_size_.height) return;
  drawn_size_ = {drawn(width), drawn(height)};
  renderer_->resize(drawn_size_.width, drawn_size_.height);
  picture_stale_ = true;
}

std::vector<HandWords> Window::hand_words() const {
  const Session& session = run_->session();
  std::vector<HandWords> all(session.setup.devices.size());
  for (std::size_t hand = 0; hand < all.size(); ++hand) {
    const scene::DeviceSetup& device = session.setup.devices[hand];
    const RowSample& newest = traces_->newest(static_cast<std::uint32_t>(hand));
    HandWords& words = all[hand];
    words.device = device.kind + (device.path.empty() ? "" : ": " + device.path);
    words.state = run_->ended() ? "the run has ended" : state_words(newest, shown_.results[hand]);
    words.engagement = newest.engagement;
    words.limited = (newest.status & (haptics::kForceClamped | haptics::kForceSlewed |
                                      haptics::kTorqueClamped | haptics::kTorqueSlewed)) != 0;
    const auto fault = static_cast<haptics::Fault>(newest.fault);
    if (fault == haptics::Fault::kNone) continue;
    words.fault = haptics::words_of(fault);
    const std::string trouble =
        hand < session.devices.size() ? session.devices[hand]->trouble() : std::string();
    if (!trouble.empty()) words.fault += " (" + trouble + ")";
    words.advice = advice_on(fault);
  }
  return all;
}

std::string Window::banner_words(bool& fault) const {
  const std::vector<HandWords> hands = hand_words();
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    if (hands[hand].fault.empty()) continue;
    fault = true;
    const std::string whose =
        hands.size() > 1 ? "Hand " + std::to_string(hand) + ": zero force" : "Zero force";
    return whose + ": " + hands[hand].fault + ".  R resets.";
  }
  if (run_->ended() && !run_->failure().empty()) {
    fault = true;
    return run_->failure();
  }
  if (next_ != nullptr) return "The next session is being prepared ...";
  if (run_->ended()) return "The run has ended.  Enter: once more.  Esc: leave.";
  if (paused_) return "The picture is held; the run goes on.  Space: on with it.";
  return {};
}

Shown Window::shown() const {
  Shown shown{run_->session().setup, request_, *traces_, shown_, tissue_, noise_, hand_words()};
  shown.recording = run_->recording().string();
  shown.ended = run_->ended();
  shown.paused = paused_;
  shown.preparing = next_ != nullptr;
  shown.frames_a_second = frames_a_second_;
  shown.frame_time = frame_time_;
  shown.age = age_;
  for (const auto& [when, age] : ages_) shown.largest_age = std::max(shown.largest_age, age);
  shown.rows_left_out = run_->rows().left_out();
  shown.tissue_note = tissue_note_;
  return shown;
}

void Window::compose() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  // The mouse as its events say, not as the system does: the two differ when events come from elsewhere.
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = ImVec2(static_cast<float>(mouse_at_.first), static_cast<float>(mouse_at_.second));
  for (std::uint32_t button = 0; button < 3; ++button) {
    io.MouseDown[button] = (((mouse_down_ | mouse_pressed_) >> button) & 1U) != 0;
  }
  mouse_pressed_ = 0;
  ImGui::NewFrame();
  layout_ = lay_out(io.DisplaySize.x, io.DisplaySize.y, scale_, panels_);
  const Shown all = shown();
  if (layout_.left.width > 0.0F) draw_left(layout_.left, all, panels_, wishes_);
  if (layout_.right.width > 0.0F) draw_right(layout_.right, all, panels_, wishes_);
  if (layout_.bottom.height > 0.0F) draw_plots(layout_.bottom, all);
  draw_overlay();
  draw_help(panels_, steering_.mouse_steers(), steering_.gamepad_steers());
  if (std::optional<ChosenFile> file = panels_.files.draw()) wishes_.file = std::move(file);
  ImGui::Render();
}

/// Title, banner and message over the picture.
void Window::draw_overlay() {
  const Rectangle& place = layout_.picture;
  const float text = ImGui::GetFontSize();
  if (place.width < 12.0F * text || place.height < 5.0F * text) {
    bool fault = false;
    banner_ = banner_words(fault);
    return;
  }
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float margin = 0.7F * text;
  const auto strip = [&](float y, const std::string& words, const ImVec4& ground) {
    const float wrap = place.width - 2.0F * margin;
    const ImVec2 size = ImGui::CalcTextSize(words.c_str(), nullptr, false, wrap);
    list.AddRectFilled(ImVec2(place.x, y), ImVec2(place.x + place.width, y + size.y + margin),
                       packed(ground, 0.94F));
    list.AddText(nullptr, 0.0F, ImVec2(place.x + margin, y + 0.5F * margin), packed(colour::kText),
                 words.c_str(), nullptr, wrap);
    return size.y + margin;
  };
  bool fault = false;
  banner_ = banner_words(fault);
  float y = place.y;
  if (!banner_.empty()) y += strip(y, banner_, fault ? colour::kFault : colour::kNews);
  const std::string title = title_of(run_->session().setup) + formatted("   %.1f s", traces_->newest_time());
  list.AddText(ImVec2(place.x + margin, y + 0.5F * margin), packed(colour::kText, 0.9F), title.c_str());
  const char* help = "F1: keys";
  const ImVec2 help_size = ImGui::CalcTextSize(help);
  if (place.width > ImGui::CalcTextSize(title.c_str()).x + help_size.x + 4.0F * margin) {
    list.AddText(ImVec2(place.x + place.width - help_size.x - margin, y + 0.5F * margin),
                 packed(colour::kText, 0.7F), help);
  }
  if (message_.empty()) return;
  const ImVec2 size = ImGui::CalcTextSize(message_.c_str(), nullptr, false, place.width - 2.0F * margin);
  strip(place.y + place.height - size.y - margin, message_, colour::kNews);
}

render::Image Window::picture() {
  const Display::Size size = display_.pixels();
  render::Image image{size.width, size.height, {}};
  const std::size_t row = static_cast<std::size_t>(size.width) * 3;
  std::vector<std::uint8_t> bottom_up(row * static_cast<std::size_t>(size.height));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.width, size.height, GL_RGB, GL_UNSIGNED_BYTE, bottom_up.data());
  image.rgb.reserve(bottom_up.size());
  for (std::size_t line = static_cast<std::size_t>(size.height); line-- > 0;) {
    const auto from = bottom_up.begin() + static_cast<std::ptrdiff_t>(line * row);
    image.rgb.insert(image.rgb.end(), from, from + static_cast<std::ptrdiff_t>(row));
  }
  return image;
}

void Window::save_picture() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  std::array<char, 64> name{};
  (void)std::strftime(name.data(), name.size(), "palpate-%Y%m%d-%H%M%S.png", &parts);
  try {
    render::write_png(picture(), name.data());
    say(std::string("the picture is in ") + name.data());
  } catch (const InputError& error) {
    say(error.what());
  }
}

WindowOutcome Window::finish() {
  run_->stop();
  next_.reset();
  if (first_ended_) {
    later_fault_ = later_fault_ || (run_->account() && run_->account()->loop.fault != haptics::Fault::kNone);
  } else {
    first_account_ = run_->account();
    first_failure_ = run_->failure();
  }
  if (!first_account_) throw InputError(first_failure_);
  WindowOutcome outcome;
  outcome.account = *first_account_;
  outcome.more_runs = runs_begun_ - 1;
  outcome.later_fault = later_fault_;
  outcome.frames = all_ages_.count();
  outcome.median_age = 1e-9 * static_cast<double>(all_ages_.percentile(0.5));
  outcome.largest_age = 1e-9 * static_cast<double>(all_ages_.max());
  return outcome;
}

WindowOutcome run_in_window(Session& first, const scene::Request& request, const WindowOptions& options) {
  Window window(first, request, options);
  while (window.frame()) {
  }
  return window.finish();
}

}  // namespace palpate::app
