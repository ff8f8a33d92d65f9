#include "bindings/python/live_simulation.h"

#include <stdexcept>
#include <utility>

#include "io/scene/device_kinds.h"
#include "palpate/error.h"
#include "run/session/usable_core.h"

#include "bindings/python/scene_arguments.h"

namespace palpate::python {
namespace {

/// Number of rows in a time span.
std::size_t rows_in(double seconds, const scene::Scene& scene) {
  const double rows = seconds * scene.rate_Hz * static_cast<double>(scene.tools.size());
  if (!(seconds >= 0.0) || rows > 1e10) throw ParameterError("keep_s", seconds, ">= 0 and not endless");
  return static_cast<std::size_t>(rows);
}

/// Checks the options before the organ is prepared, which takes longer. @return the scene
scene::Scene checked(scene::Scene scene, const LiveSimulation::Options& options) {
  session::require_usable_core(options.thread.core, "core");
  (void)rows_in(options.keep_s, scene);
  check_surface_edge(options.surface_edge);
  for (const scene::DeviceSetup& device : scene.devices) {
    const scene::DeviceKind* known = scene::find_device_kind(device.kind);
    if (known == nullptr || !known->window) continue;
    throw InputError("device " + device.kind + ": needs the window of a run; Python has no window");
  }
  return scene;
}

session::SessionOptions session_options(const LiveSimulation::Options& options) {
  session::SessionOptions session;
  session.duration_s = options.duration_s;
  session.preparation = preparation_of(options.cache);
  return session;
}

}  // namespace

RowCollector::RowCollector(std::size_t hands, std::size_t kept)
    : hands_(hands), kept_(kept), thread_([this](const std::stop_token& stop) { collect(stop); }) {}

RowCollector::~RowCollector() = default;

void RowCollector::on_row(const haptics::TickRow& row) noexcept {
  newest_.writable()[row.hand] = row;
  if (row.hand + 1 == hands_) newest_.publish();
  if (!ring_.push(row)) left_out_.fetch_add(1, std::memory_order_relaxed);
}

std::optional<RowCollector::Newest> RowCollector::newest() {
  const std::lock_guard lock(readers_);
  any_ = newest_.refresh() || any_;
  if (!any_) return std::nullopt;
  return newest_.value();
}

std::vector<haptics::TickRow> RowCollector::rows() {
  const std::lock_guard lock(readers_);
  drain();
  return {rows_.begin(), rows_.end()};
}

std::uint64_t RowCollector::rows_missing() {
  const std::lock_guard lock(readers_);
  return dropped_ + left_out_.load(std::memory_order_relaxed);
}

/// Moves the queued rows to rows_. The caller must have locked readers_.
void RowCollector::drain() {
  haptics::TickRow row;
  while (ring_.pop(row)) {
    rows_.push_back(row);
    if (rows_.size() <= kept_) continue;
    rows_.pop_front();
    ++dropped_;
  }
}

void RowCollector::collect(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kEvery{20};
  while (!stop.stop_requested()) {
    {
      const std::lock_guard lock(readers_);
      drain();
    }
    std::this_thread::sleep_for(kEvery);
  }
}

LiveSimulation::LiveSimulation(scene::Scene scene, Options options)
    : options_(std::move(options)),
      session_(checked(std::move(scene), options_), session_options(options_)),
      rows_(hands(), rows_in(options_.keep_s, session_.scene())) {}

LiveSimulation::~LiveSimulation() { stop(); }

void LiveSimulation::require_own() const {
  if (is_own()) return;
  throw std::logic_error("the simulation was made before fork(), must be used by the process that made it");
}

void LiveSimulation::start() {
  using namespace std::chrono_literals;
  require_own();
  const std::lock_guard lock(state_);
  if (run_ != nullptr) throw std::logic_error("the simulation was started before; make another one");
  session::RunOptions how;
  how.recording = options_.record.value_or(std::filesystem::path());
  how.thread = options_.thread;
  auto run = session_.run_in_background(std::move(how), {&rows_, &snapshots_});
  while (!rows_.newest() && !run->wait_for(1ms)) continue;
  if (!rows_.newest() && !run->failure().empty()) throw InputError(run->failure());
  run_ = std::move(run);
}

/// Null before start().
session::BackgroundRun* LiveSimulation::run() {
  require_own();
  const std::lock_guard lock(state_);
  return run_.get();
}

void LiveSimulation::stop() {
  if (!is_own()) return;
  session::BackgroundRun* under_way = run();
  if (under_way == nullptr) return;
  under_way->stop();
  under_way->wait();
  rows_.rest();
}

bool LiveSimulation::ended_within(std::chrono::milliseconds time) {
  const session::BackgroundRun* under_way = run();
  return under_way != nullptr && under_way->wait_for(time);
}

bool LiveSimulation::running() {
  const session::BackgroundRun* under_way = run();
  return under_way != nullptr && !under_way->ended();
}

std::vector<haptics::TickRow> LiveSimulation::newest() {
  require_own();
  const auto newest = rows_.newest();
  if (!newest) return {};
  return {newest->begin(), newest->begin() + static_cast<std::ptrdiff_t>(hands())};
}

std::string LiveSimulation::describe_fault(const haptics::TickRow& row) const {
  const auto fault = static_cast<haptics::Fault>(row.fault);
  if (fault == haptics::Fault::kNone) return {};
  const std::string last_error = session_.devices()[row.hand]->last_error();
  return haptics::describe(fault) + (last_error.empty() ? std::string() : " (" + last_error + ")");
}

std::uint64_t LiveSimulation::change() {
  require_own();
  const std::lock_guard lock(looking_);
  (void)snapshots_.cell().refresh();
  return snapshots_.cell().value().change;
}

Surface LiveSimulation::surface() {
  require_own();
  const std::lock_guard lock(looking_);
  if (!deformer_) {
    deformer_ = std::make_unique<deform::SurfaceDeformer>(
        visible_surface(scene(), options_.surface_edge),
        deform::prepare_response(scene().organ, scene().support, scene().store.get()));
  }
  (void)snapshots_.cell().refresh();
  haptics::Snapshot snapshot = snapshots_.cell().value();
  if (snapshot.hands == 0) snapshot.organ_W = scene().organ_pose;  // before the first tick
  return surface_at(snapshot, *deformer_);
}

std::vector<haptics::TickRow> LiveSimulation::rows() {
  require_own();
  return rows_.rows();
}

std::uint64_t LiveSimulation::rows_missing() {
  require_own();
  return rows_.rows_missing();
}

session::RunResult LiveSimulation::result() {
  const session::BackgroundRun* under_way = run();
  if (under_way == nullptr || !under_way->ended()) {
    throw std::logic_error("the simulation has not ended: its outcome is not known yet");
  }
  return under_way->result().value_or(session::RunResult());
}

std::string LiveSimulation::take_failure() {
  if (!is_own()) return {};
  const std::lock_guard lock(state_);
  if (run_ == nullptr || !run_->ended() || std::exchange(failure_reported_, true)) return {};
  return run_->failure();
}

}  // namespace palpate::python
