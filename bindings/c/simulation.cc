#include "bindings/c/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/haptics/prepared_update.h"
#include "io/system/clock.h"
#include "io/system/path_text.h"

#include "bindings/c/errors.h"
#include "bindings/c/float_environment.h"

namespace palpate::c_interface {
namespace {

using haptics::Fault;

/// Delay [s] of a held hand's scripted path: 0.25 s at rest and 0.5 s of force ramp, with a margin.
constexpr double kSettle = 1.0;

Vec3 vector_of(const double (&values)[3]) noexcept { return {values[0], values[1], values[2]}; }

void put(const Vec3& from, double (&to)[3]) noexcept {
  to[0] = from.x();
  to[1] = from.y();
  to[2] = from.z();
}

void put(const Quat& from, double (&to)[4]) noexcept {
  to[0] = from.w();
  to[1] = from.x();
  to[2] = from.y();
  to[3] = from.z();
}

template <std::size_t kSize>
void put(const std::array<double, kSize>& from, double (&to)[kSize]) noexcept {
  std::copy(from.begin(), from.end(), to);
}

/// An unknown number becomes the fault of a device that could not be read.
Fault fault_of(std::uint32_t number) noexcept {
  return number <= PALPATE_FAULT_FORCE_OFF ? static_cast<Fault>(number) : Fault::kDevice;
}

haptics::DeviceState state_of(const palpate_sample& sample) noexcept {
  haptics::DeviceState state;
  state.position_D = vector_of(sample.position);
  state.orientation_D =
      Quat(sample.orientation[0], sample.orientation[1], sample.orientation[2], sample.orientation[3]);
  state.velocity_D = vector_of(sample.velocity);
  state.gripper = sample.gripper;
  state.age = sample.age;
  state.buttons = sample.buttons;
  state.fault = fault_of(sample.fault);
  return state;
}

geometry::TriangleMesh visible_surface(const scene::Scene& scene, double longest_edge) {
  return longest_edge > 0.0 ? geometry::refine(scene.organ, longest_edge) : scene.organ;
}

}  // namespace

void require_usable(const palpate_simulation* simulation) {
  require_given(simulation, "simulation");
  if (!simulation->is_own()) throw UseError(kForked);
}

}  // namespace palpate::c_interface

namespace {

using palpate::c_interface::put;

}  // namespace

palpate_simulation::palpate_simulation(palpate::c_interface::Loaded loaded, const palpate_options& options)
    : scene_(std::move(loaded.scene)),
      scripted_(std::move(loaded.scripted)),
      world_(std::move(loaded.world)),
      state_(world_),
      samples_(world_.hands()),
      commands_(world_.hands()),
      rows_(world_.hands()),
      deformer_(palpate::c_interface::visible_surface(scene_, options.surface_edge),
                palpate::deform::prepare_response(scene_.organ, scene_.support, scene_.store.get())) {
  updates_.emplace(world_, scene_.tissue, palpate::haptics::ParameterUpdates::Warnings{});
  if (options.record_file != nullptr) {
    recorder_ = palpate::record::make_recorder(palpate::to_path(options.record_file), scene_,
                                               options.record_waits != 0);
  }
  publish();
  vertices_ = deformer_.rest().vertices;
}

void palpate_simulation::take_samples(const palpate_sample* samples) noexcept {
  const std::uint32_t resets = resets_.exchange(0, std::memory_order_relaxed);
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    samples_[hand] = palpate::c_interface::state_of(samples[hand]);
    if (((resets >> hand) & 1U) != 0) samples_[hand].events |= palpate::haptics::kResetFault;
  }
}

/// Applies the oldest change that waits, from this tick on.
void palpate_simulation::take_update() noexcept {
  const palpate::haptics::PreparedUpdate* update = updates_->waiting(next_tick_);
  if (update == nullptr) return;
  palpate::haptics::apply_update(world_, state_, *update);
  palpate::haptics::ParameterUpdate noted = update->values;
  noted.tick = next_tick_;
  updates_->taken();
  for (palpate::haptics::DeviceState& sample : samples_) sample.events |= palpate::haptics::kParameterUpdated;
  if (recorder_) recorder_->on_update(noted);
}

void palpate_simulation::give_result(std::size_t hand, palpate_result& result) const noexcept {
  const palpate::haptics::TickRow& row = rows_[hand];
  const palpate::haptics::ForceCommand command_D = world_.mappings[hand].to_device(commands_[hand]);
  result.tick = row.tick;
  result.time = row.time;
  put(command_D.force, result.device_force);
  put(command_D.torque, result.device_torque);
  result.gripper_force = row.gripper_force;
  put(row.force, result.force);
  put(row.torque, result.torque);
  result.tissue_force = row.tissue_force;
  result.noise_force = row.noise_force;
  result.friction = row.friction;
  result.distance = row.distance;
  result.depth = row.depth;
  put(row.contact, result.contact);
  put(row.normal, result.normal);
  put(row.tool, result.tool_position);
  put(row.tool_q, result.tool_orientation);
  result.gripper = row.gripper;
  result.energy = row.energy;
  result.engagement = row.engagement;
  result.layer = static_cast<std::uint32_t>(row.layer);
  result.phase = row.phase;
  result.cutoff_layer = row.cutoff_layer;
  result.saturated = row.saturated;
  result.status = row.status;
  result.fault = row.fault;
}

void palpate_simulation::publish() noexcept {
  const std::uint64_t tick = next_tick_ == 0 ? 0 : next_tick_ - 1;
  palpate::haptics::make_snapshot({state_, commands_, tick, palpate::monotonic_ns()}, snapshots_.writable());
  snapshots_.publish();
}

const palpate::haptics::Snapshot& palpate_simulation::newest_snapshot() noexcept {
  (void)snapshots_.refresh();
  return snapshots_.value();
}

void palpate_simulation::tick(const palpate_sample* samples, palpate_result* results) noexcept {
  const palpate::c_interface::DefaultFloatEnvironment environment;
  take_samples(samples);
  if (next_tick_ == 0 && recorder_) recorder_->on_start(palpate::unix_ns());
  take_update();
  palpate::haptics::tick(world_, state_, next_tick_, samples_, commands_, rows_);
  ++next_tick_;
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    give_result(hand, results[hand]);
    if (recorder_) recorder_->on_row(rows_[hand]);
  }
  publish();
}

void palpate_simulation::scripted_sample(std::size_t hand, std::uint64_t tick_number,
                                         palpate_sample& sample) noexcept {
  const palpate::c_interface::DefaultFloatEnvironment environment;
  const double rate = world_.rate_Hz;
  const auto wait = static_cast<std::uint64_t>(
      world_.mappings[hand].held ? std::ceil(palpate::c_interface::kSettle * rate) : 0.0);
  const std::uint64_t at = tick_number > wait ? tick_number - wait : 0;
  palpate::haptics::DeviceState state = scripted_[hand]->read(at, static_cast<double>(at) / rate);
  if (tick_number < wait) state.velocity_D.setZero();
  put(state.position_D, sample.position);
  put(state.orientation_D, sample.orientation);
  put(state.velocity_D, sample.velocity);
  sample.gripper = state.gripper;
  sample.age = state.age;
  sample.buttons = state.buttons;
  sample.fault = static_cast<std::uint32_t>(state.fault);
}

void palpate_simulation::restart() {
  state_ = palpate::haptics::SimulationState(world_);
  updates_.emplace(world_, scene_.tissue, palpate::haptics::ParameterUpdates::Warnings{});
  std::fill(commands_.begin(), commands_.end(), palpate::haptics::ForceCommand{});
  next_tick_ = 0;
  resets_.store(0);
  publish();
}

void palpate_simulation::finish_recording() {
  if (!recorder_) return;
  palpate::haptics::LoopReport report;
  report.ticks = next_tick_;
  report.remarks.emplace_back(
      "ticked by a program through the C interface: its ticks' times were not measured");
  recorder_->finish(report);
}

palpate_info palpate_simulation::info() const noexcept {
  palpate_info info{};
  info.struct_size = sizeof info;
  info.hands = static_cast<std::uint32_t>(hands());
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    if (!world_.mappings[hand].held) continue;
    info.held |= std::uint32_t{1} << hand;
  }
  info.rate = world_.rate_Hz;
  info.max_force = scene_.safety.max_force;
  info.max_torque = scene_.safety.max_torque;
  info.seed = scene_.seed;
  for (const auto& device : scripted_) {
    info.scripted_ticks = std::max(info.scripted_ticks, device->last_tick(world_.rate_Hz));
  }
  if (info.held != 0) {
    info.scripted_ticks += static_cast<std::uint64_t>(std::ceil(palpate::c_interface::kSettle * info.rate));
  }
  info.vertices = rest_surface().vertices.size();
  info.triangles = rest_surface().triangles.size();
  info.remarks = scene_.repairs.size() + scene_.remarks.size();
  for (std::size_t hand = 0; hand < hands(); ++hand) {
    info.tool_parts[hand] = static_cast<std::uint32_t>(scene_.tools[hand].parts.size());
  }
  return info;
}

void palpate_simulation::update_surface(palpate_picture& picture) {
  const palpate::haptics::Snapshot& snapshot = newest_snapshot();
  deformer_.deform(snapshot.reach, palpate::deform::indentations_of(snapshot.hand_results()), vertices_);
  picture.tick = snapshot.tick;
  put(snapshot.organ_W.position, picture.organ_position);
  put(snapshot.organ_W.rotation, picture.organ_orientation);
  for (std::size_t hand = 0; hand < snapshot.hands; ++hand) {
    put(snapshot.tools[hand].pose_W.position, picture.tool_position[hand]);
    put(snapshot.tools[hand].pose_W.rotation, picture.tool_orientation[hand]);
    picture.gripper[hand] = snapshot.tools[hand].gripper;
  }
}
