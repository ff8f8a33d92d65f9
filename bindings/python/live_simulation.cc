#include "bindings/python/live_simulation.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/devices/devices.h"
#include "palpate/haptics/realtime.h"
#include "palpate/record/assemble.h"
#include "palpate/record/flight_recorder.h"
#include "palpate/record/recorder.h"
#include "palpate/scene/device_kinds.h"

#include "bindings/python/scene_arguments.h"

namespace palpate::python {
namespace {

constexpr double kMostTicks = 1e12;  // 30 years at 1 kHz: a longer duration is a typing mistake

void require_usable_core(std::optional<int> core) {
  if (!core) return;
  const std::vector<int> cores = haptics::usable_cores();
  if (std::find(cores.begin(), cores.end(), *core) != cores.end()) return;
  std::string list;
  for (const int usable : cores) list += (list.empty() ? "" : ", ") + std::to_string(usable);
  throw ParameterError("core", *core, "a core that this program may use: " + list);
}

/// Rows that are kept of so many seconds.
std::size_t rows_in(double seconds, const haptics::SimulationWorld& world) {
  const double rows = seconds * world.rate_Hz * static_cast<double>(world.hands());
  if (!(seconds >= 0.0) || rows > 1e10) throw ParameterError("keep_s", seconds, ">= 0 and not endless");
  return static_cast<std::size_t>(rows);
}

}  // namespace

RowCollector::RowCollector(haptics::TickSink& next, std::size_t hands, std::size_t kept)
    : next_(next),
      hands_(hands),
      kept_(kept),
      thread_([this](const std::stop_token& stop) { collect(stop); }) {}

RowCollector::~RowCollector() = default;

void RowCollector::begin(std::int64_t started_unix_ns) noexcept { next_.begin(started_unix_ns); }

void RowCollector::put_change(const haptics::LiveChange& change) noexcept { next_.put_change(change); }

void RowCollector::put(const haptics::TickRow& row) noexcept {
  newest_.writable()[row.hand] = row;
  if (row.hand + 1 == hands_) newest_.publish();
  if (!ring_.push(row)) left_out_.fetch_add(1, std::memory_order_relaxed);
  next_.put(row);
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

/// Whoever holds readers_ takes what has come.
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

LiveSimulation::LiveSimulation(scene::Setup setup, Options options)
    : setup_(std::move(setup)),
      options_(std::move(options)),
      world_(record::assemble(setup_, preparation_of(options_.cache))) {
  require_usable_core(options_.thread.core);
  (void)rows_in(options_.keep_s, world_);
  check_surface_edge(options_.surface_edge);
  open_devices();
  ticks_ = ticks_to_run();
  for (auto& remarks : {record::radius_remarks(setup_, world_), record::stability_remarks(setup_)}) {
    setup_.remarks.insert(setup_.remarks.end(), remarks.begin(), remarks.end());
  }
  changes_ = record::live_changes(setup_, world_);
}

LiveSimulation::~LiveSimulation() { stop(); }

void LiveSimulation::open_devices() {
  for (std::size_t hand = 0; hand < setup_.devices.size(); ++hand) {
    const std::string& kind = setup_.devices[hand].kind;
    const scene::DeviceKind* known = scene::find_device_kind(kind);
    if (known != nullptr && known->window) {
      throw InputError("device " + kind + ": the window of a run feeds it, and there is none in Python");
    }
    devices_.push_back(devices::open_device(setup_, hand));
  }
}

std::uint64_t LiveSimulation::ticks_to_run() const {
  const double rate = setup_.rate_Hz;
  if (options_.duration_s) {
    const double ticks = std::round(*options_.duration_s * rate);
    if (!(*options_.duration_s > 0.0) || !(ticks <= kMostTicks)) {
      throw ParameterError("duration_s", *options_.duration_s,
                           "> 0 and at most " + std::to_string(kMostTicks / rate));
    }
    return static_cast<std::uint64_t>(ticks);
  }
  std::uint64_t last = 0;
  for (const auto& device : devices_) last = std::max(last, device->last_tick(rate));
  return last;
}

void LiveSimulation::start() {
  std::unique_lock lock(state_);
  if (begun_) throw std::logic_error("the simulation was started before; make another one");
  if (options_.record) {
    sink_ = std::make_unique<record::Recorder>(*options_.record, setup_, false);
  } else {
    sink_ = std::make_unique<record::FlightRecorder>(nullptr, setup_);
  }
  rows_ = std::make_unique<RowCollector>(*sink_, hands(), rows_in(options_.keep_s, world_));
  begun_ = true;
  thread_ = std::thread([this] { run(); });
  const auto under_way = [this] { return ended_ || done_.load(std::memory_order_relaxed) > 0; };
  while (!under_way()) changed_.wait_for(lock, std::chrono::milliseconds(1));
}

void LiveSimulation::run() {
  try {
    haptics::SimulationState state(world_);
    std::vector<haptics::Device*> devices;
    for (const auto& device : devices_) devices.push_back(device.get());
    outcome_.loop = haptics::run_loop(world_, state, devices, rows_.get(),
                                      {.ticks = ticks_,
                                       .stop = &stop_,
                                       .snapshots = &snapshots_,
                                       .progress = &done_,
                                       .resets = &resets_,
                                       .changes = changes_.get(),
                                       .thread = options_.thread,
                                       .stalled_after_ns = haptics::stall_limit_ns(world_)});
    finish_sink();
  } catch (const std::exception& error) {
    outcome_.failure = error.what();
  }
  rows_->rest();
  const std::lock_guard lock(state_);
  ended_ = true;
  changed_.notify_all();
}

/// Closes the recording, or keeps what led to a fault of a run that nobody recorded.
void LiveSimulation::finish_sink() {
  if (auto* recorder = dynamic_cast<record::Recorder*>(sink_.get())) {
    recorder->finish(outcome_.loop);
    return;
  }
  const auto& flight = dynamic_cast<const record::FlightRecorder&>(*sink_);
  if (!flight.fault_met()) return;
  try {
    outcome_.fault_recording = record::keep_flight(flight, outcome_.loop);
  } catch (const InputError& failure) {
    outcome_.loop.remarks.push_back(std::string("the ticks before the fault were not kept: ") +
                                    failure.what());
  }
}

void LiveSimulation::stop() {
  stop_.store(true, std::memory_order_relaxed);
  const std::lock_guard lock(joining_);
  if (thread_.joinable()) thread_.join();
}

bool LiveSimulation::ended_within(std::chrono::milliseconds time) {
  std::unique_lock lock(state_);
  return begun_ && changed_.wait_for(lock, time, [this] { return ended_; });
}

bool LiveSimulation::running() {
  const std::lock_guard lock(state_);
  return begun_ && !ended_;
}

std::vector<haptics::TickRow> LiveSimulation::newest() {
  RowCollector* rows = collector();
  const auto newest = rows == nullptr ? std::nullopt : rows->newest();
  if (!newest) return {};
  return {newest->begin(), newest->begin() + static_cast<std::ptrdiff_t>(hands())};
}

std::string LiveSimulation::fault_words(const haptics::TickRow& row) const {
  const auto fault = static_cast<haptics::Fault>(row.fault);
  if (fault == haptics::Fault::kNone) return {};
  const std::string trouble = devices_[row.hand]->trouble();
  return haptics::words_of(fault) + (trouble.empty() ? std::string() : " (" + trouble + ")");
}

std::uint64_t LiveSimulation::change() {
  const std::lock_guard lock(looking_);
  (void)snapshots_.refresh();
  return snapshots_.value().change;
}

Surface LiveSimulation::surface() {
  const std::lock_guard lock(looking_);
  if (!deformer_) {
    deformer_ = std::make_unique<deform::SurfaceDeformer>(visible_surface(setup_, options_.surface_edge));
  }
  (void)snapshots_.refresh();
  haptics::Snapshot snapshot = snapshots_.value();
  if (snapshot.hands == 0) snapshot.organ_W = setup_.organ_pose;  // before the first tick
  return surface_at(snapshot, *deformer_);
}

/// Null before start().
RowCollector* LiveSimulation::collector() {
  const std::lock_guard lock(state_);
  return begun_ ? rows_.get() : nullptr;
}

std::vector<haptics::TickRow> LiveSimulation::rows() {
  RowCollector* rows = collector();
  return rows == nullptr ? std::vector<haptics::TickRow>() : rows->rows();
}

std::uint64_t LiveSimulation::rows_missing() {
  RowCollector* rows = collector();
  return rows == nullptr ? 0 : rows->rows_missing();
}

const LiveSimulation::Outcome& LiveSimulation::outcome() {
  const std::lock_guard lock(state_);
  if (!ended_) throw std::logic_error("the simulation has not ended: its outcome is not known yet");
  return outcome_;
}

std::string LiveSimulation::take_failure() {
  const std::lock_guard lock(state_);
  if (!ended_ || failure_told_) return {};
  failure_told_ = true;
  return outcome_.failure;
}

}  // namespace palpate::python
