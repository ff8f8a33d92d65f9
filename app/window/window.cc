#include "app/window/window.h"

#include <epoxy/gl.h>
#include <fmt/core.h>
#include <imgui.h>

#include "core/haptics/gate.h"
#include "core/haptics/simulation.h"
#include "io/system/clock.h"
#include "palpate/error.h"
#include "palpate/tool_path.h"

#include "app/messages.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr std::int64_t kFrameNs = 16'000'000;  // at most 62 frames per second
constexpr std::int64_t kAgesKeptNs = 3'000'000'000;
constexpr std::int64_t kSettlingNs = 1'000'000'000;  // longest settling before a run

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
    case haptics::Fault::kUnstable:
      return "Choose a softer tissue or a faster loop, then reset.";
    case haptics::Fault::kNone:
      break;
  }
  return {};
}

/// The organ at rest without tools, and where a scripted tool begins. The first view is the same as that of
/// the run's first tick.
haptics::Snapshot at_rest(const Session& session) {
  const scene::Scene& scene = session.scene();
  haptics::Snapshot snapshot;
  snapshot.organ_W = scene.organ_pose;
  if (scene.task == scene::Task::kPalpate) return snapshot;  // its view does not depend on the tool
  haptics::SimulationState state(session.world());
  std::vector<haptics::DeviceState> samples(session.hands());
  for (std::size_t hand = 0; hand < samples.size(); ++hand) {
    const scene::PathRow start = scene::default_path(scene, hand).at(0.0);
    samples[hand].position_D = start.position;
    samples[hand].orientation_D = start.orientation;
    samples[hand].gripper = start.gripper;
  }
  std::vector<haptics::ForceCommand> commands(samples.size());
  std::vector<haptics::TickRow> rows(samples.size());
  haptics::tick(session.world(), state, 0, samples, commands, rows);
  haptics::make_snapshot({state, commands, 0}, snapshot);
  snapshot.hands = 0;
  return snapshot;
}

}  // namespace

Window::Window(std::shared_ptr<Session> first, scene::Overrides request, WindowOptions options)
    : request_(std::move(request)),
      options_(std::move(options)),
      viewport_("Palpate", options_.size, options_.scale),
      now_(first->scene()) {
  SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);  // without it the window has no gamepads
  SDL_PumpEvents();
  take(std::move(first), options_.recording);
}

Window::~Window() {
  if (run_ != nullptr) run_->stop();
  next_.reset();
  if (viewport_.display().lost()) {
    live_.abandon();
    return;
  }
  SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}

bool Window::frame() {
  frame_began_ns_ = monotonic_ns();
  leaving_ |= viewport_.take_events(
      options_.stop, [this](const SDL_Event& event, std::pair<int, int> way) { take_event(event, way); });
  poll_runs();
  if (!run_->started()) {
    show_preparing();
    begin();
  }
  take_rows();
  if (leaving_) return false;
  poll_search();
  poll_recording();
  point_the_tool();
  const std::int64_t steered_before_ns = std::exchange(steered_ns_, monotonic_ns());
  steering_.update_devices(camera_, shown_, 1e-9 * static_cast<double>(steered_ns_ - steered_before_ns));
  const Traces::NoiseStatistics statistics = traces_->take_noise_statistics();
  steering_.rumble(statistics.tissue, statistics.noise);

  draw_frame();
  live_.adapt(frame_time_);
  note_age();
  grant(std::exchange(commands_, {}));
  sleep_until_ns(frame_began_ns_ + kFrameNs);
  const double whole = 1e-9 * static_cast<double>(monotonic_ns() - frame_began_ns_);
  frames_a_second_ += 0.1 * (1.0 / whole - frames_a_second_);
  return true;
}

void Window::draw_frame() {
  compose();
  take_newest();
  draw_picture();
  Viewport::draw_panels();
  if (std::exchange(commands_.screenshot, false)) viewport_.save(picture());
  glFinish();
  recover_graphics();
  frame_time_ = 1e-9 * static_cast<double>(monotonic_ns() - frame_began_ns_);
  viewport_.show();
}

/// Draws the organ at rest until resolution and quality fit the machine. This happens before the run, so that
/// the user does not see outdated pictures during contact.
void Window::settle_picture() {
  shown_ = at_rest(run_->session());
  snapshot_there_ = true;
  const bool camera_was_set = camera_set_;
  const std::int64_t until = monotonic_ns() + kSettlingNs;
  do {
    frame_began_ns_ = monotonic_ns();
    draw_frame();
  } while (!live_.settle(frame_time_) && frame_began_ns_ < until);
  camera_set_ = camera_was_set;
  snapshot_there_ = false;
  rest_there_ = true;
}

/// Records the age of the snapshot that this frame has shown.
void Window::note_age() {
  if (!snapshot_there_ || paused_ || run_->ended() || run_->pausing()) return;
  const std::int64_t now = monotonic_ns();
  all_ages_.add(now - shown_.taken_ns);
  age_ = 1e-9 * static_cast<double>(now - shown_.taken_ns);
  ages_.emplace_back(now, age_);
  while (ages_.front().first < now - kAgesKeptNs) ages_.pop_front();
}

void Window::take_newest() {
  const bool answers = search_ != nullptr && search_->ended();  // without the tool, see poll_search()
  if (paused_ || answers || !run_->snapshots().refresh()) return;
  shown_ = run_->snapshots().value();
  snapshot_there_ = true;
  live_.refresh();
}

/// Reduces the picture after memory ran out; closes the window if the graphics card has lost its memory.
void Window::recover_graphics() {
  if (Viewport::out_of_memory()) {
    const bool smaller = live_.shrink();
    viewport_.show_message(std::string("the graphics card's memory ran out") +
                           (smaller ? ": the picture is coarser" : ""));
  }
  if (viewport_.graphics_lost()) viewport_.display().give_up();
}

void Window::draw_picture() {
  viewport_.clear();
  live_.show_drape(panels_.drape);
  const Rectangle& place = layout_.picture;
  if (place.width < 1.0F || place.height < 1.0F) return;
  if (!snapshot_there_) {
    if (rest_there_) live_.show(shown_, camera_.camera(), place, viewport_);
    return;
  }
  if (reach_changed_ && !ImGui::IsAnyItemActive()) make_renderer();
  if (!camera_set_) {
    look_as_at_start(camera_, subject(), shown_, search_ != nullptr, aspect());
    camera_set_ = true;
    camera_controller_.forget();
    take_newest();  // choosing the view of a large organ takes time
  }
  keep_in_frame();
  live_.show(shown_, camera_.camera(), place, viewport_);
}

std::vector<HandStatus> Window::hand_texts() const {
  const Session& session = run_->session();
  std::vector<HandStatus> all(session.scene().devices.size());
  for (std::size_t hand = 0; hand < all.size(); ++hand) {
    const scene::DeviceSetup& device = session.scene().devices[hand];
    const haptics::TickRow& newest = traces_->newest(static_cast<std::uint32_t>(hand));
    HandStatus& status = all[hand];
    status.device = device.kind + (device.path.empty() ? "" : ": " + device.path);
    status.state = run_->ended()     ? "the run has ended"
                   : snapshot_there_ ? moment_text(newest, now_.tissue, 1)
                                     : "begins";
    if (!run_->ended() && (newest.status & contact::kExtrapolated) != 0) status.state += ", past its range";
    if (!run_->ended() && (newest.status & contact::kAtHub) != 0) status.state += ", up to its hub";
    status.engagement = run_->ended() ? 0.0 : newest.engagement;
    status.limited = (newest.status & (haptics::kForceClamped | haptics::kForceSlewed |
                                       haptics::kTorqueClamped | haptics::kTorqueSlewed)) != 0;
    const auto fault = static_cast<haptics::Fault>(newest.fault);
    if (fault == haptics::Fault::kNone) continue;
    status.fault = haptics::describe(fault);
    const std::string last_error =
        hand < session.devices().size() ? session.devices()[hand]->last_error() : std::string();
    if (!last_error.empty()) status.fault += " (" + last_error + ")";
    status.advice = advice_on(fault);
  }
  return all;
}

std::string Window::banner_text(bool& fault) const {
  const std::vector<HandStatus> hands = hand_texts();
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    if (hands[hand].fault.empty()) continue;
    fault = true;
    const std::string whose = hands.size() > 1 ? fmt::format("Hand {}: zero force", hand) : "Zero force";
    return fmt::format("{}: {}.  R resets.", whose, hands[hand].fault);
  }
  if (run_->ended() && !run_->failure().empty()) {
    fault = true;
    return run_->failure();
  }
  if (next_ != nullptr) return "The next session is being prepared ...";
  if (search_ != nullptr && search_->ended()) {
    return "The search has ended: " + answer_text(*search_->score()) +
           "  Rings: the lumps. Dots and crosses: right and false marks.";
  }
  if (run_->ended()) return "The run has ended.  Enter: once more.  Esc: leave.";
  if (run_->pausing()) return "The run is paused: no time passes in it.  Ctrl + Space: on with it.";
  if (paused_) return "The picture is held; the run goes on.  Space: on with it.";
  return {};
}

PanelModel Window::shown() const {
  PanelModel shown{
      run_->session().scene(), request_, *traces_, shown_, now_.tissue, now_.noise, hand_texts()};
  shown.inclusions = now_.inclusions;
  shown.recording = recording() ? recording_now().string() : std::string();
  shown.records_run = tape_ == nullptr;
  shown.recording_note = recording_note();
  shown.looked_at = last_recording_.string();
  shown.ended = run_->ended();
  shown.paused = paused_;
  shown.pausing = run_->pausing();
  shown.may_pause = run_->session().may_pause();
  shown.preparing = next_ != nullptr;
  shown.frames_a_second = frames_a_second_;
  shown.frame_time = frame_time_;
  shown.age = age_;
  for (const auto& [when, age] : ages_) shown.largest_age = std::max(shown.largest_age, age);
  shown.rows_left_out = run_->observer().left_out();
  shown.tissue_note = tissue_note_;
  shown.can_undo = history_.can_undo();
  shown.can_redo = history_.can_redo();
  if (support_ != nullptr) shown.support = support_->status(live_);
  if (insertion_ != nullptr) {
    shown.inserts = true;
    if (shown.ended) shown.insertion = palpation::measures(insertion_->score());
  }
  if (search_ != nullptr) {
    shown.search = search_->status();
    if (steering_.mouse_steers()) shown.search->pointer_gain = search_->pointer_gain(*traces_);
  }
  return shown;
}

void Window::compose() {
  viewport_.begin_panels();
  const ImGuiIO& io = ImGui::GetIO();
  layout_ = lay_out(io.DisplaySize.x, io.DisplaySize.y, viewport_.scale(), panels_);
  const PanelModel all = shown();
  if (layout_.left.width > 0.0F) draw_left(layout_.left, all, panels_, commands_);
  if (layout_.right.width > 0.0F) draw_right(layout_.right, all, panels_, commands_);
  if (layout_.bottom.height > 0.0F) draw_plots(layout_.bottom, plotted(all));
  draw_overlay();
  draw_help(panels_, gestures());
  draw_leave_dialog(all, panels_, commands_);
  const SceneGallery::Choice choice = panels_.gallery.draw();
  if (choice.scene != nullptr) commands_.scene = choice.scene;
  if (choice.browse) {
    panels_.files.open(FileUse::kScene, request_.scene
                                            ? std::filesystem::absolute(*request_.scene).parent_path()
                                            : std::filesystem::current_path());
  }
  if (std::optional<ChosenFile> file = panels_.files.draw()) commands_.file = std::move(file);
  Viewport::end_panels();
}

/// Says what the window waits for: a new picture takes time.
void Window::show_preparing() {
  viewport_.begin_panels();
  const ImGuiIO& io = ImGui::GetIO();
  layout_ = lay_out(io.DisplaySize.x, io.DisplaySize.y, viewport_.scale(), panels_);
  const std::string organ = std::filesystem::path(run_->session().scene().organ_name).filename().string();
  const std::string text = "Preparing the organ: " + organ + " ...";
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  ImGui::GetBackgroundDrawList()->AddText(
      ImVec2(0.5F * (io.DisplaySize.x - size.x), 0.5F * (io.DisplaySize.y - size.y)), packed(colour::kText),
      text.c_str());
  Viewport::end_panels();
  viewport_.clear();
  Viewport::draw_panels();
  viewport_.show();
}

/// Moves back while a tool or a contact is outside the picture, until the user moves the view. A tool under
/// the mouse is always inside.
void Window::keep_in_frame() {
  constexpr double kFarther = 1.02;  // a frame
  if (steering_.mouse_steers() || camera_controller_.used()) return;
  if (!contacts_in_frame(shown_, camera_.camera(), aspect())) camera_.zoom(kFarther);
}

Gestures Window::gestures() const {
  const Session& session = run_->session();
  Gestures all;
  all.mouse = steering_.mouse_steers();
  all.gamepad = steering_.gamepad_steers();
  for (const geometry::Tool& tool : session.scene().tools) {
    for (const geometry::ToolPart& part : tool.parts) all.jaws = all.jaws || part.is_jaw;
  }
  all.search = search_ != nullptr;
  all.needle = needle_.has_value();
  all.may_pause = session.may_pause();
  all.hands = session.hands();
  return all;
}

/// Draws marks, hint, title, banner and message over the picture.
void Window::draw_overlay() {
  bool fault = false;
  if (snapshot_there_)
    draw_marks(layout_.picture, camera_, shown_, panels_.marks, needle_ ? &*needle_ : nullptr);
  for (const contact::ToolResult& result : shown_.hand_results()) {
    touched_ = touched_ || result.phase != contact::Phase::kApproach;
  }
  const std::string hint = touched_ || !snapshot_there_ ? std::string() : first_hint(gestures());
  if (!hint.empty()) draw_hint(layout_.picture, hint);
  banner_ = banner_text(fault);
  viewport_.draw_overlay(layout_.picture, {{banner_, fault}, {tissue_note_, false}},
                         title_of(run_->session().scene()) + formatted("   %.1f s", traces_->newest_time()));
}

WindowOutcome Window::finish() {
  if (!run_->started()) run_->start();  // an unstarted run has no result
  close_run();
  next_.reset();
  if (first_ended_) {
    later_fault_ = later_fault_ || (run_->result() && run_->result()->loop.fault != haptics::Fault::kNone);
  } else {
    first_result_ = run_->result();
    first_failure_ = run_->failure();
  }
  if (!first_result_) throw InputError(first_failure_);
  WindowOutcome outcome;
  outcome.result = *first_result_;
  outcome.more_runs = runs_begun_ - 1;
  outcome.later_fault = later_fault_;
  outcome.searches = searches_;
  outcome.frames = all_ages_.count();
  outcome.median_age = 1e-9 * static_cast<double>(all_ages_.percentile(0.5));
  outcome.largest_age = 1e-9 * static_cast<double>(all_ages_.max());
  outcome.display_lost = viewport_.display().lost();
  return outcome;
}

WindowOutcome run_in_window(std::shared_ptr<Session> first, const scene::Overrides& request,
                            const WindowOptions& options) {
  Window window(std::move(first), request, options);
  try {
    while (window.frame()) {
    }
  } catch (const DisplayLost& lost) {
    report_message(std::string(lost.what()) + ": the run ends as when its window is closed");
  }
  return window.finish();
}

}  // namespace palpate::app
