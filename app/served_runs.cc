#include "app/served_runs.h"

#include <iostream>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "core/haptics/simulation.h"
#include "io/scene/names.h"
#include "io/scene/variation_reader.h"
#include "io/system/clock.h"
#include "io/system/path_text.h"
#include "net/live_protocol.h"
#include "palpate/surface.h"

#include "app/messages.h"
#include "app/served_devices.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using net::LiveError;

haptics::LiveNoise live(const noise::NoiseSettings& noise) {
  return {noise.enabled, noise.gain, noise.threshold};
}

/// @throws InputError for an inclusion that is not inside the organ
void require_inside(const scene::InclusionSetup& inclusion, const geometry::TriangleMesh& organ) {
  scene::InclusionTable table;
  table.setup = inclusion;
  table.has_centre = true;
  table.where = "set_inclusion";
  scene::Scene probe;
  probe.organ = organ;
  scene::place_inclusions({table}, probe);
}

}  // namespace

ServedRuns::ServedRuns(ServedOptions options, std::unique_ptr<Session> first)
    : options_(std::move(options)),
      first_(std::move(first)),
      own_device_flag_(options_.request.device),
      own_devices_(first_->scene().devices),
      now_(first_->scene()) {}

const scene::Scene& ServedRuns::scene() const {
  return run_ != nullptr ? run_->session().scene() : first_->scene();
}

void ServedRuns::send_event(const std::string& event, Json members) {
  events_.push_back({std::nullopt, event, std::move(members)});
}

/// File of the next recording: its name gets the number of the run, or the next number without a file. A
/// client must not replace an existing recording.
fs::path ServedRuns::next_recording() const {
  if (options_.recording.empty()) return {};
  const std::string stem = to_text(options_.recording.stem());
  fs::path file = options_.recording;
  std::error_code error;
  for (std::uint64_t number = runs_ + 1;; ++number) {
    if (number > 1) {
      file.replace_filename(stem + "-" + std::to_string(number) + to_text(options_.recording.extension()));
    }
    // An error counts as absent: the recorder then reports that it cannot create the file.
    const bool is_newest = run_ != nullptr && file == run_->recording();  // its file may not exist yet
    if (!is_newest && !fs::exists(fs::symlink_status(file, error))) return file;
  }
}

void ServedRuns::begin(std::unique_ptr<Session> session, fs::path recording) {
  ++runs_;
  const std::size_t hands = session->hands();
  const double rate_Hz = session->scene().rate_Hz;
  end_recording();
  tape_.reset();  // it refers to the previous session
  run_ = std::make_unique<LiveRun<ServedObserver>>(std::move(session), std::move(recording), options_.thread,
                                                   nullptr, hands, rate_Hz);
  if (options_.page) {
    if (run_->recording().empty()) tape_ = std::make_unique<RunTape>(scene());
    mice_ = mice_of(run_->session());
    for (const GamepadHand& hand : gamepads_of(run_->session())) pads_.push_back({hand});
    moved_hands_ns_ = monotonic_ns();
  }
  recording_failure_.clear();
  rate_Hz_.reset();
  rate_ns_ = 0;
  run_->start();
  accounted_ = false;
  surface_.reset();
  moved_ns_ = 0;
  first_.reset();
  now_ = LiveParameters(run_->session().scene());
  send_event("run", {{"run", about_run()}});
}

void ServedRuns::begin_first() { begin_first(options_.recording); }

void ServedRuns::begin_first(fs::path recording) {
  const model::TissueParameters tissue = now_.tissue;  // a client may have changed it before the first run
  const haptics::LiveNoise noise = live(now_.noise);
  const bool other_tissue = net::tissue_json(tissue) != net::tissue_json(first_->scene().tissue);
  const bool other_noise = !(noise == live(first_->scene().noise));
  begin(std::move(first_), std::move(recording));
  if (other_tissue) {
    (void)run_->session().updates().offer(tissue);
    now_.tissue = tissue;
  }
  if (other_noise) {
    (void)run_->session().updates().offer(noise);
    now_.noise.enabled = noise.enabled;
    now_.noise.gain = noise.gain;
    now_.noise.threshold = noise.threshold;
  }
}

ServedRuns::Answer ServedRuns::answer(const net::LiveCommand& command, const net::ClientRef& client) {
  if (std::holds_alternative<net::GetScene>(command)) return describe();
  if (const auto* ask = std::get_if<net::GetSurface>(&command)) return surface(ask->at_rest);
  if (const auto* ask = std::get_if<net::GetTool>(&command)) return tool(ask->hand);
  if (std::holds_alternative<net::GetPicture>(command)) return picture();
  if (const auto* wanted = std::get_if<net::Load>(&command)) return load(*wanted, client);
  if (const auto* wanted = std::get_if<net::Start>(&command)) return start(*wanted, client);
  if (std::holds_alternative<net::Stop>(command)) return stop(client);
  if (std::holds_alternative<net::GetDevices>(command)) return devices();
  if (const auto* wanted = std::get_if<net::Record>(&command)) return record(wanted->on);
  if (const auto* input = std::get_if<net::SteerMouse>(&command)) return steer(*input);
  if (const auto* input = std::get_if<net::SteerGamepad>(&command)) return steer(*input);
  if (const auto* tissue = std::get_if<net::SetTissue>(&command)) return set_tissue(tissue->edit);
  if (const auto* noise = std::get_if<net::SetNoise>(&command)) return set_noise(noise->edit);
  if (const auto* inclusion = std::get_if<net::SetInclusion>(&command)) return set_inclusion(inclusion->edit);
  if (std::holds_alternative<net::ResetFaults>(command)) {
    if (!running()) throw LiveError("state", "reset_faults: nothing is running");
    run_->session().control().reset_faults();
    return Json::object();
  }
  throw LiveError("command", "do: is not a command for a scene", "do");
}

Json ServedRuns::about_run() {
  Json about{{"number", runs_},
             {"state", run_ == nullptr ? "waiting"
                       : accounted_    ? "ended"
                                       : "running"},
             {"loading", is_loading()},
             {"scene", scene().name},
             {"rate_Hz", scene().rate_Hz}};
  if (run_ == nullptr) return about;
  about.update(about_recording());
  if (!accounted_) return about;
  if (const std::optional<RunResult> result = run_->result()) {
    about["ticks"] = result->loop.ticks;
    about["missed_deadlines"] = result->loop.missed_deadlines;
    about["stopped_early"] = result->loop.stopped_early;
    about["fault"] = haptics::name_of(result->loop.fault);
  }
  if (const std::string failure = run_->failure(); !failure.empty()) about["failure"] = failure;
  return about;
}

net::LiveState ServedRuns::newest() {
  net::LiveState state;
  if (run_ == nullptr) return state;
  state.run = runs_;
  state.rate_Hz = rate_Hz_;
  state.tick = run_->observer().live.newest();
  if (state.tick == nullptr) return state;
  const haptics::SimulationWorld& world = run_->session().world();
  state.organ_W = world.organ_motion.pose_at(world.organ_W, state.tick->tick, world.rate_Hz);
  return state;
}

ServedRuns::Answer ServedRuns::describe() const {
  Json json = net::scene_json(scene());
  json.update(net::inclusions_json(now_.inclusions));
  return Json{{"scene", json},
              {"tissue", net::tissue_json(now_.tissue)},
              {"noise", net::noise_json(live(now_.noise))}};
}

ServedRuns::Answer ServedRuns::surface(bool at_rest) {
  constexpr std::int64_t kBetween = 20'000'000;  // ns; many clients within it share one surface
  if (!surface_) surface_.emplace(scene().organ, scene().support, scene().store.get());
  if (at_rest) {
    Json whole{{"run", runs_}};
    whole.update(surface_->at_rest());
    return Json{{"surface", whole}};
  }
  const haptics::Snapshot& snapshot = newest_snapshot("surface");
  if (const std::int64_t now = monotonic_ns(); now >= moved_ns_) {
    moved_ns_ = now + kBetween;
    moved_ = {{"run", runs_}, {"tick", snapshot.tick}};
    moved_.update(surface_->moved(snapshot.reach, deform::indentations_of(snapshot.hand_results())));
  }
  return Json{{"surface", moved_}};
}

const haptics::Snapshot& ServedRuns::newest_snapshot(const std::string& command) {
  if (run_ != nullptr) (void)run_->snapshots().refresh();
  if (run_ == nullptr || run_->snapshots().value().hands == 0)
    throw LiveError("state", command + ": nothing has been played yet");
  return run_->snapshots().value();
}

ServedRuns::Answer ServedRuns::tool(std::uint32_t hand) const {
  const std::vector<geometry::Tool>& tools = scene().tools;
  if (hand >= tools.size()) {
    throw LiveError("refused",
                    fmt::format("hand = {}: must be less than {}, the number of hands", hand, tools.size()),
                    "hand");
  }
  Json json{{"run", runs_}, {"hand", hand}};
  json.update(net::tool_json(tools[hand]));
  return Json{{"tool", json}};
}

ServedRuns::Answer ServedRuns::picture() {
  Json json{{"run", runs_}};
  json.update(net::picture_json(newest_snapshot("picture")));
  return Json{{"picture", json}};
}

bool ServedRuns::is_loading() const noexcept {
  return load_next_.has_value() || (next_ != nullptr && !next_->is_broken_off());
}

void ServedRuns::require_no_loading() const {
  if (load_next_ || next_ != nullptr)
    throw LiveError("state", "a scene is already being loaded; wait for its run event");
}

/// Cancels the load of a scene. The client that asked for it gets an error. Does not wait for the loading
/// thread, which ends by itself.
void ServedRuns::break_off_loading(const std::string& why) {
  if (is_loading()) {
    events_.push_back({std::exchange(next_client_, std::nullopt), "", {}, LiveError("state", why)});
  }
  load_next_.reset();
  if (next_ != nullptr) next_->break_off();
}

std::string ServedRuns::file_below(const std::string& key, const std::string& name) const {
  if (options_.scenes.empty()) {
    throw LiveError(
        "refused",
        key + " = \"" + name + "\": this server was started without --scenes, so clients cannot name files",
        key);
  }
  std::error_code error;
  const fs::path root = fs::weakly_canonical(options_.scenes, error);
  const fs::path file = fs::weakly_canonical(root / name, error);
  const fs::path inside = file.lexically_relative(root);
  if (error || inside.empty() || *inside.begin() == "..") {
    throw LiveError("refused", key + " = \"" + name + "\": must be a file below the server's --scenes", key);
  }
  return to_text(file);
}

scene::Overrides ServedRuns::request_of(const net::Load& wanted) const {
  const auto name_or_file = [this](const char* key, const std::optional<std::string>& text) {
    return text && scene::is_path(*text) ? file_below(key, *text) : text;
  };
  scene::Overrides request;
  if (wanted.scene) request.scene = file_below("scene", *wanted.scene);
  request.task = wanted.task;
  request.organ = name_or_file("organ", wanted.organ);
  request.organ_unit = wanted.organ_unit;
  request.inclusions = wanted.inclusions;
  request.tissue = name_or_file("tissue", wanted.tissue);
  if (const auto tool = name_or_file("tool", wanted.tool)) request.tools.push_back(*tool);
  request.tool_unit = wanted.tool_unit;
  if (wanted.device) require_made_up(*wanted.device);
  request.device = wanted.device;
  request.rate_Hz = wanted.rate_Hz;
  request.seed = wanted.seed;
  request.no_noise = wanted.no_noise;
  request.files_below = options_.scenes;
  return request;
}

/// Check of the next scene, which runs on the thread that reads it.
NextSession::Check ServedRuns::check_of(bool is_clients) const {
  if (options_.page) return {};
  if (!is_clients) return require_windowless;
  return [own = own_devices_](const scene::Scene& scene) {
    require_windowless(scene);
    require_named(scene, own);
  };
}

ServedRuns::Answer ServedRuns::load(const net::Load& wanted, const net::ClientRef& client) {
  scene::Overrides request = request_of(wanted);
  break_off_loading("the load was cancelled by the next load");
  load_next_ = std::move(request);
  next_client_ = client;
  poll_next();
  return std::nullopt;
}

ServedRuns::Answer ServedRuns::start(const net::Start& wanted, const net::ClientRef& client) {
  require_no_loading();
  if (running()) throw LiveError("state", "start: a run is in progress; stop it first, or load a scene");
  scene::Overrides request = options_.request;
  if (wanted.device) request.device = device_flag(*wanted.device);
  const bool same = first_ != nullptr && first_->scene().inclusions == now_.inclusions &&
                    request.device == options_.request.device;
  if (same && !first_->devices().empty()) {
    begin_first(next_recording());
    return Json{{"run", about_run()}};
  }
  next_ = std::make_unique<NextSession>(std::move(request), now_, next_recording(),
                                        check_of(request_is_clients_));
  next_is_clients_ = request_is_clients_;
  next_client_ = client;
  return std::nullopt;
}

ServedRuns::Answer ServedRuns::stop(const net::ClientRef& client) {
  const bool loading = is_loading();
  if (!running() && !loading) throw LiveError("state", "stop: nothing is running");
  break_off_loading("the load was cancelled by stop");
  if (!running()) return Json{{"run", about_run()}};
  run_->session().control().stop();
  stop_clients_.push_back(client);
  return std::nullopt;
}

ServedRuns::Answer ServedRuns::set_tissue(const net::TissueEdit& edit) {
  const model::TissueParameters tissue = net::edited(now_.tissue, edit);
  model::validate(tissue);
  Json answer{{"change", nullptr}, {"warnings", Json::array()}};
  if (running()) {
    const haptics::ParameterUpdates::Accepted accepted = run_->session().updates().offer(tissue);
    answer["change"] = accepted.number;
    answer["warnings"] = accepted.warnings;
  }
  now_.tissue = tissue;
  send_event("tissue", {{"change", answer["change"]}, {"tissue", net::tissue_json(now_.tissue)}});
  return answer;
}

ServedRuns::Answer ServedRuns::set_noise(const net::NoiseEdit& edit) {
  const haptics::LiveNoise noise = net::edited(live(now_.noise), edit);
  noise::NoiseSettings settings = now_.noise;
  settings.enabled = noise.enabled;
  settings.gain = noise.gain;
  settings.threshold = noise.threshold;
  noise::validate(settings, scene().rate_Hz);
  Json answer{{"change", nullptr}};
  if (running()) answer["change"] = run_->session().updates().offer(noise).number;
  now_.noise = settings;
  send_event("noise", {{"change", answer["change"]}, {"noise", net::noise_json(noise)}});
  return answer;
}

ServedRuns::Answer ServedRuns::set_inclusion(const net::InclusionEdit& edit) {
  const std::size_t index = net::find_inclusion(now_.inclusions, edit);
  const scene::InclusionSetup changed = net::edited(now_.inclusions[index], edit);
  model::validate(changed.inclusion);
  Json answer{{"change", nullptr}, {"warnings", Json::array()}};
  if (running()) {
    const Vec3& centre_S = changed.inclusion.centre_S;
    const haptics::ParameterUpdates::Accepted accepted =
        run_->session().updates().offer(haptics::LiveInclusion{static_cast<std::uint32_t>(index),
                                                               {centre_S.x(), centre_S.y(), centre_S.z()},
                                                               changed.inclusion.ratio});
    answer["change"] = accepted.number;
    answer["warnings"] = accepted.warnings;
  } else if (edit.centre_S) {
    require_inside(changed, scene().organ);
  }
  now_.inclusions[index] = changed;
  send_event("inclusion", {{"change", answer["change"]},
                           {"inclusion", net::inclusion_json(now_.inclusions[index], index)}});
  return answer;
}

std::vector<net::Event> ServedRuns::poll(std::size_t clients) {
  if (clients == 0 && had_clients_ && options_.stop_when_alone && running()) {
    report_message("the last client has disconnected: the run ends (--stop-when-alone)");
    run_->session().control().stop();
  }
  had_clients_ = clients > 0;
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed) && run_ != nullptr)
    run_->session().control().stop();
  if (running()) {
    const bool ended = run_->ended();  // read first: every fault event must precede the end event
    report_faults();
    (void)run_->snapshots().refresh();
    move_hands();
    measure_rate();
    if (ended) account_for_run();
  }
  poll_recording();
  poll_next();
  return std::exchange(events_, {});
}

void ServedRuns::report_faults() {
  while (const std::optional<net::FaultTransition> turn = run_->observer().live.take_fault()) {
    const std::string last_error = run_->session().devices()[turn->hand]->last_error();
    Json fault{{"run", runs_},
               {"tick", turn->tick},
               {"time_s", static_cast<double>(turn->tick) / scene().rate_Hz},
               {"hand", turn->hand},
               {"fault", haptics::name_of(turn->fault)},
               {"words", haptics::describe(turn->fault)}};
    if (turn->fault != haptics::Fault::kNone && !last_error.empty()) fault["trouble"] = last_error;
    send_event("fault", {{"fault", fault}});
  }
}

void ServedRuns::account_for_run() {
  run_->stop();
  mice_.clear();
  pads_.clear();
  run_->session().close_devices();
  accounted_ = true;
  poll_recording();
  end_recording();
  if (const std::optional<RunResult> result = run_->result()) {
    fault_ = fault_ || result->loop.fault != haptics::Fault::kNone;
    failed_ = failed_ || !result->recording_failure.empty();
    const OutputFiles files{run_->recording(), {}, {}};
    if (options_.json) {
      // In one text, which is written or dropped as a whole.
      std::cout << net::text_of({{"run", summary_json(*result, files)}}) + "\n" << std::flush;
    } else {
      print_summary(std::cout, *result, files);
      std::cout << std::flush;
    }
  } else {
    failed_ = true;
    report_error(run_->failure());
  }
  send_event("run", {{"run", about_run()}});
  for (const net::ClientRef& client : std::exchange(stop_clients_, {})) {
    events_.push_back({client, "", {{"run", about_run()}}});
  }
}

void ServedRuns::poll_next() {
  if (next_ != nullptr && next_->is_broken_off() && next_->is_idle()) next_.reset();
  if (next_ == nullptr && load_next_) {
    next_ = std::make_unique<NextSession>(*std::exchange(load_next_, std::nullopt), KeptParameters(),
                                          next_recording(), check_of(true));
    next_is_clients_ = true;
  }
  if (next_ == nullptr || next_->is_broken_off()) return;
  switch (next_->state()) {
    case NextSession::State::kRead:
      if (running()) return run_->session().control().stop();  // zero force before the preparation
      if (first_ != nullptr) first_->close_devices();
      next_->prepare_now(options_.duration_s, options_.no_cache);
      break;
    case NextSession::State::kReady: {
      const std::unique_ptr<NextSession> next = std::move(next_);
      options_.request = next->request();
      request_is_clients_ = next_is_clients_;
      begin(next->take(), next->recording());
      events_.push_back({std::exchange(next_client_, std::nullopt), "", {{"run", about_run()}}});
      break;
    }
    case NextSession::State::kFailed:
      events_.push_back(
          {std::exchange(next_client_, std::nullopt), "", {}, LiveError("refused", next_failure())});
      next_.reset();
      break;
    case NextSession::State::kReading:
    case NextSession::State::kPreparing:
      break;
  }
}

/// Error message for the client when the next session cannot be played. A message about a file of the command
/// line goes to standard error instead, because it may quote a line of that file, which a client other than
/// the user's page must not see.
std::string ServedRuns::next_failure() const {
  if (next_is_clients_ || options_.page) return next_->failure();
  report_error(next_->failure());
  return "the scene that the server was started with cannot be run; the server's own messages give the "
         "reason";
}

void ServedRuns::finish() {
  if (next_ != nullptr) next_->break_off();
  if (running()) account_for_run();
  end_recording();
  next_.reset();
}

}  // namespace palpate::app
