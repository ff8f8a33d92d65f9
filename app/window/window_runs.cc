// Sessions of a window, one after the other.
#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <imgui.h>
#include <sys/wait.h>

#include "io/scene/support_reader.h"
#include "io/system/child_process.h"
#include "io/system/file_exists.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "view/report/subject.h"

#include "app/window/window.h"

namespace palpate::app {

namespace fs = std::filesystem;

/// Switches the window to this run, which starts with the next frame.
void Window::take(std::shared_ptr<Session> session, fs::path recording) {
  insertion_.reset();
  search_.reset();  // search, support and tape refer to the previous session
  support_.reset();
  tape_.reset();
  run_ = std::make_unique<LiveRun<RowObserver>>(std::move(session), std::move(recording), options_.thread,
                                                options_.igtl);
  ++runs_begun_;
  const scene::Scene& scene = run_->session().scene();
  if (run_->recording().empty()) {
    tape_ = std::make_unique<RunTape>(scene);
  } else {
    last_recording_ = run_->recording();
  }
  run_closed_ = false;
  ended_by_user_ = false;
  answered_ = false;
  now_ = LiveParameters(scene);
  history_.clear();
  tissue_note_.clear();
  traces_ = std::make_unique<Traces>(scene.rate_Hz);
  snapshot_there_ = false;
  rest_there_ = false;
  paused_ = false;
  tissue_waits_ = false;
  noise_waits_ = false;
  inclusions_wait_ = false;
  if (scene.task == scene::Task::kPalpate) {
    search_ = std::make_unique<Search>(run_->session());
  } else {
    support_ = std::make_unique<SupportEditor>(scene);
  }
  needle_ = NeedleMarks::of(scene, run_->session().world().contact);
  if (palpation::is_insertion(scene)) {
    insertion_ = std::make_unique<palpation::InsertionScorer>(scene, run_->session().world().contact);
  }
  steering_.take(run_->session());
  viewport_.display().set_title("Palpate: " + title_of(scene));
}

void Window::begin() {
  make_renderer();
  live_.forget_times();
  settle_picture();
  run_->start();
}

/// Makes the renderer of the session's organ. Its surface deforms as the current tissue; its colours are
/// those of the session's first tissue.
void Window::make_renderer() {
  live_.take(subject());
  if (support_ != nullptr) support_->draw_on(live_);
  reach_changed_ = false;
}

render::Subject Window::subject() const {
  render::Subject subject = report::subject_of(run_->session().scene());
  subject.reach = now_.tissue.reach;
  if (support_ != nullptr) subject.support = support_->in_force();
  subject.inclusions = scene::visible_inclusions(now_.inclusions);
  return subject;
}

void Window::take_rows() {
  traces_->take(run_->observer(), !paused_, [this](const haptics::TickRow& row) {
    if (search_ != nullptr) search_->add(row);
    if (insertion_ != nullptr) insertion_->add(row);
    if (tape_ != nullptr) tape_->add(row);
  });
  haptics::ParameterUpdate update;
  while (run_->observer().take(update)) {
    if (tape_ != nullptr) tape_->add(update);
  }
  if (search_ != nullptr && search_->take_untouched_marks() > 0) {
    viewport_.show_message("no mark: the tool does not touch the tissue. Press, then mark.");
  }
}

/// Shows hidden inclusions too, in the picture.
void Window::show_all_inclusions() {
  std::vector<model::Inclusion> all;
  for (const scene::InclusionSetup& one : now_.inclusions) all.push_back(one.inclusion);
  live_.show_inclusions(std::move(all));
  live_.refresh();
}

/// Slows the mouse over stiff places; at the end of a search shows lumps and marks, at the end of an
/// insertion what was hidden.
void Window::poll_search() {
  if (insertion_ != nullptr && run_->ended() && !std::exchange(answered_, true)) show_all_inclusions();
  steering_.set_gain(search_ == nullptr ? 1.0 : search_->pointer_gain(*traces_));
  if (search_ == nullptr) return;
  const bool ends = !search_->ended() && run_->ended();
  if (ends) search_->end();
  search_->draw_on(live_, ends);
  if (!ends) return;
  // The organ at rest without the tool, which would hide the last mark.
  const Pose organ_W = shown_.organ_W;
  shown_ = {};
  shown_.organ_W = organ_W;
  show_all_inclusions();
}

/// Ends the run: zero force, recording closed, devices free for the next session.
void Window::end_run() {
  close_run();
  steering_.drop();
  run_->session().close_devices();
  const bool fault = run_->result() && run_->result()->loop.fault != haptics::Fault::kNone;
  if (!first_ended_) {
    first_ended_ = true;
    first_result_ = run_->result();
    first_failure_ = run_->failure();
  } else if (fault) {
    later_fault_ = true;
  }
}

/// Stops the run and completes its recording and its search.
void Window::close_run() {
  if (std::exchange(run_closed_, true)) return;
  run_->stop();
  take_rows();
  end_recording();
  if (search_ == nullptr && insertion_ == nullptr) return;
  if (search_ != nullptr) search_->end();
  const palpation::AnyScore score =
      search_ != nullptr ? palpation::AnyScore(*search_->score()) : insertion_->score();
  searches_.push_back({recording_now(), run_->session().scene().seed, run_->observer().left_out(), score});
}

void Window::poll_runs() {
  poll_next();
  if (!run_->ended() || next_ != nullptr) return;
  if (!options_.stays && !ended_by_user_) leaving_ = true;
}

void Window::poll_next() {
  if (next_ == nullptr) return;
  switch (next_->state()) {
    case NextSession::State::kRead:
      end_run();
      next_->prepare_now(options_.duration_s, options_.no_cache);
      break;
    case NextSession::State::kReady: {
      const std::unique_ptr<NextSession> next = std::move(next_);
      request_ = next->request();
      const Selection before = selection();
      take(next->take(), next->recording());
      const Selection after = selection();
      camera_set_ = camera_set_ && before.organ == after.organ;
      if (std::string changes = changes_text(before, after); !changes.empty()) {
        viewport_.show_message(std::move(changes));
      }
      break;
    }
    case NextSession::State::kFailed:
      viewport_.show_message(next_->failure());
      next_.reset();
      break;
    case NextSession::State::kReading:
    case NextSession::State::kPreparing:
      break;
  }
}

/// What the session simulates, with the parameters in force.
Selection Window::selection() const {
  const scene::Scene& scene = run_->session().scene();
  Selection now{.task = scene::to_string(scene.task),
                .organ = scene.organ_name,
                .tissue = now_.tissue,
                .noise = now_.noise};
  for (const geometry::Tool& tool : scene.tools) now.tool += (now.tool.empty() ? "" : " and ") + tool.name;
  for (const scene::DeviceSetup& device : scene.devices) {
    now.device += (now.device.empty() ? "" : " and ") + device.kind;
  }
  return now;
}

/// Starts another session. Where the first was recorded (--record) it is, too, in a file of its own.
void Window::restart(scene::Overrides request, Keep keep) {
  if (next_ != nullptr) {
    viewport_.show_message("the next session is being prepared already");
    return;
  }
  KeptParameters kept;
  if (keep.tissue) kept.tissue = now_.tissue;
  if (keep.noise) kept.noise = now_.noise;
  if (keep.inclusions) kept.inclusions = now_.inclusions;
  next_ = std::make_unique<NextSession>(
      std::move(request), std::move(kept),
      options_.recording.empty() ? fs::path() : free_name(options_.recording, false));
}

/// Opens a recording in a separate process, which cannot delay the running loop. The viewer shows the rows
/// that have been written so far.
void Window::look_at(const fs::path& recording) {
  try {
    observers_.open(options_.viewer, recording);
    viewport_.show_message(recording.filename().string() + " opens in a window of its own");
  } catch (const InputError& error) {
    viewport_.show_message(error.what());
  }
}

/// Changes the tissue at one of the next ticks of the loop, or for the next run when none is running.
void Window::apply_tissue(const model::TissueParameters& tissue) {
  try {
    model::validate(tissue);
    tissue_note_.clear();
    if (run_->ended()) {
      tissue_note_ = "felt from the next run on (Enter)";
    } else if (run_->pausing()) {
      tissue_note_ = "felt when the run goes on (Ctrl + Space)";
      tissue_waits_ = true;
    } else {
      for (const std::string& warning : run_->session().updates().offer(tissue).warnings) {
        tissue_note_ += (tissue_note_.empty() ? "" : "\n") + warning;
      }
    }
    reach_changed_ = reach_changed_ || tissue.reach != now_.tissue.reach;
    now_.tissue = tissue;
  } catch (const InputError& error) {
    tissue_note_ = error.what();
  }
}

void Window::apply_noise(const noise::NoiseSettings& noise) {
  try {
    noise::validate(noise, run_->session().scene().rate_Hz);
    if (run_->pausing()) {
      noise_waits_ = true;
    } else if (!run_->ended()) {
      (void)run_->session().updates().offer(haptics::LiveNoise{noise.enabled, noise.gain, noise.threshold});
    }
    now_.noise = noise;
  } catch (const InputError& error) {
    viewport_.show_message(error.what());
  }
}

/// Changes an inclusion at one of the next ticks of the loop, or for the next run when none is running.
void Window::apply_inclusion(const haptics::LiveInclusion& change) {
  try {
    if (run_->pausing()) {
      inclusions_wait_ = true;
    } else if (!run_->ended()) {
      const std::vector<std::string>& known = run_->session().scene().remarks;
      for (const std::string& warning : run_->session().updates().offer(change).warnings) {
        if (std::find(known.begin(), known.end(), warning) == known.end()) viewport_.show_message(warning);
      }
    }
    model::Inclusion& inclusion = now_.inclusions.at(change.index).inclusion;
    inclusion.centre_S = Vec3(change.centre_S[0], change.centre_S[1], change.centre_S[2]);
    inclusion.ratio = change.ratio;
    live_.show_inclusions(scene::visible_inclusions(now_.inclusions));
  } catch (const InputError& error) {
    viewport_.show_message(error.what());
  }
}

/// Applies changes of parameters, and keeps the former ones for undo.
void Window::apply_parameters(const Commands& commands) {
  const bool held = ImGui::IsAnyItemActive();
  history_.next_frame(held);
  const LiveParameters before = now_;
  if (commands.tissue) apply_tissue(*commands.tissue);
  if (commands.noise) apply_noise(*commands.noise);
  if (commands.inclusion) apply_inclusion(*commands.inclusion);
  if (!equal(before, now_)) history_.add(before, held);
  if (commands.undo) undo_or_redo(*commands.undo);
}

void Window::undo_or_redo(bool undo) {
  const std::optional<LiveParameters> wanted = undo ? history_.undo(now_) : history_.redo(now_);
  if (wanted) {
    apply_all(*wanted);
  } else {
    viewport_.show_message(undo ? "no change of this run is left to undo" : "nothing is left to redo");
  }
}

void Window::apply_all(const LiveParameters& wanted) {
  if (wanted.tissue != now_.tissue) apply_tissue(wanted.tissue);
  LiveParameters other_noise = now_;
  other_noise.noise = wanted.noise;
  if (!equal(other_noise, now_)) apply_noise(wanted.noise);
  for (std::size_t i = 0; i < wanted.inclusions.size(); ++i) {
    const model::Inclusion& inclusion = wanted.inclusions[i].inclusion;
    if (inclusion == now_.inclusions[i].inclusion) continue;
    const Vec3& centre_S = inclusion.centre_S;
    apply_inclusion(
        {static_cast<std::uint32_t>(i), {centre_S.x(), centre_S.y(), centre_S.z()}, inclusion.ratio});
  }
}

/// Pauses or resumes the run. Parameter updates wait until it resumes; only the latest of each kind is kept.
void Window::pause_run() {
  if (!run_->session().may_pause()) {
    viewport_.show_message("a hand holds the device: its run is never paused; Space holds the picture");
    return;
  }
  if (run_->ended()) return;
  run_->session().control().pause(!run_->pausing());
  if (run_->pausing()) return;
  if (std::exchange(tissue_waits_, false)) apply_tissue(now_.tissue);
  if (std::exchange(noise_waits_, false)) apply_noise(now_.noise);
  if (!std::exchange(inclusions_wait_, false)) return;
  for (std::size_t i = 0; i < now_.inclusions.size(); ++i) {
    const model::Inclusion& now = now_.inclusions[i].inclusion;
    const model::Inclusion before = run_->session().updates().inclusions()[i];
    if (now == before) continue;
    apply_inclusion(
        {static_cast<std::uint32_t>(i), {now.centre_S.x(), now.centre_S.y(), now.centre_S.z()}, now.ratio});
  }
}

/// Further runs of the same organ keep the support that the user chose.
void Window::keep_support() {
  if (!support_->changed()) return;
  const std::optional<geometry::Support> support = support_->in_force();
  if (support && !support->painted.empty()) return;  // no flag gives painted places again
  request_.organ_support = support ? scene::support_flags(*support) : std::vector<std::string>{"none"};
}

void Window::take_file(const ChosenFile& file) {
  scene::Overrides request = request_;
  Keep keep = Keep::all();
  switch (file.use) {
    case FileUse::kOrgan:
      request.organ = file.path.string();
      request.organ_unit = file.unit;
      request.organ_frame.reset();  // that of the file's header
      if (run_->session().scene().support || !request.organ_support.empty()) request.organ_support = {"none"};
      keep = {.noise = true};
      break;
    case FileUse::kTool:
    case FileUse::kFurtherJaw:
      if (file.use == FileUse::kTool) request.tools.clear();
      request.tools.push_back(file.path.string());
      request.tool_unit = file.unit;
      break;
    case FileUse::kScene:
      request = {};
      request.scene = file.path;
      keep = {};
      break;
    case FileUse::kToolPath:
      request.device = "scripted:" + file.path.string();
      break;
    case FileUse::kTissue:
      try {
        apply_tissue(scene::read_tissue_file(file.path));
      } catch (const InputError& error) {
        viewport_.show_message(error.what());
      }
      return;
    case FileUse::kRecording:
      look_at(file.path);
      return;
    case FileUse::kSaveTissue:
      try {
        write_output(file.path, scene::to_toml(now_.tissue));
        viewport_.show_message("the tissue is in " + file.path.string());
      } catch (const InputError& error) {
        viewport_.show_message(error.what());
      }
      return;
  }
  restart(std::move(request), keep);
}

void Window::grant(const Commands& commands) {
  if (commands.leave) leaving_ = true;
  apply_parameters(commands);
  if (commands.reset_faults) run_->session().control().reset_faults();
  if (commands.pause) paused_ = !paused_;
  if (commands.pause_run) pause_run();
  if (commands.home) camera_set_ = false;
  if (commands.full_screen) viewport_.display().toggle_full_screen();
  if (commands.map && search_ != nullptr) {
    search_->shows_map = *commands.map;
    search_->draw_on(live_, true);
  }
  if (commands.support && support_ != nullptr) {
    support_->apply(*commands.support, live_);
    keep_support();
  }
  if (commands.end_search) {
    ended_by_user_ = true;
    run_->session().control().stop();
  }
  if (commands.look) {
    if (last_recording_.empty()) {
      viewport_.show_message("nothing is recorded yet: Ctrl + R records");
    } else {
      look_at(last_recording_);
    }
  }
  if (commands.file) take_file(*commands.file);
  if (commands.record) record(*commands.record);
  if (commands.scene != nullptr) {
    restart(scene::request_of(*commands.scene, device_for_user(run_->session().scene())), {});
  }
  if (commands.request) restart(*commands.request, commands.keep);
  if (commands.again) restart(request_, Keep::all());
}

void Observers::open(const std::filesystem::path& program, const std::filesystem::path& recording) {
  if (!regular_file_exists(recording))
    throw InputError(recording.string() + ": there is no such recording (it appears with the first tick)");
  const std::string file = std::filesystem::absolute(recording).string();
  // The viewer must not inherit device handles, nor the lock on the recording, which would outlive the
  // writer. Ctrl-C in the terminal ends the run, not the viewer.
  std::error_code error;
  const int child = start_process({.arguments = {program.string(), "view", file}, .apart = true}, error);
  if (error) throw InputError(file + ": the viewer does not start: " + error.message());
  children_.push_back(child);
  (void)count_running();
}

std::size_t Observers::count_running() {
  const auto ended = [](pid_t child) { return waitpid(child, nullptr, WNOHANG) != 0; };
  std::erase_if(children_, ended);
  return children_.size();
}

}  // namespace palpate::app
