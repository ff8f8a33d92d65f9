#pragma once
// The simulation behind a palpate_simulation handle.
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/haptics/simulation.h"
#include "io/record/make_recorder.h"
#include "io/system/own_process.h"
#include "palpate/parameter_updates.h"
#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"
#include "palpate/triple_buffer.h"

#include "bindings/c/palpate.h"

namespace palpate::c_interface {

/// Scene, prepared for a simulation.
struct Loaded {
  scene::Scene scene;
  std::vector<std::unique_ptr<haptics::Device>> scripted;  // per hand, source of palpate_scripted_sample()
  haptics::SimulationWorld world;
};

/// [setup] The scene that the options ask for. @throws UseError
[[nodiscard]] scene::Overrides request_of(const palpate_options& options);

/// [setup] Reads the scene and prepares the organ. @throws InputError
[[nodiscard]] Loaded load(const palpate_options& options, const scene::Overrides& request);

/// [setup] Prepares a scene that has been read. @param no_hand as palpate_options.no_hand
[[nodiscard]] Loaded load(scene::Scene scene, const contact::Preparation& how, bool no_hand);

/// Error of a call in a child process for a simulation of its parent.
inline constexpr const char* kForked =
    "simulation: was opened before fork(), must be used by the process that opened it";

/// [setup] @throws UseError when the simulation is null or of the parent process.
void require_usable(const palpate_simulation* simulation);

}  // namespace palpate::c_interface

/// One simulation of the C interface. One thread ticks it; another may read its snapshots.
struct palpate_simulation {
 public:
  /// [setup] @throws InputError if the recording cannot be created.
  palpate_simulation(palpate::c_interface::Loaded loaded, const palpate_options& options);

  /// [rt] Computes the next tick, with one sample and one result per hand.
  void tick(const palpate_sample* samples, palpate_result* results) noexcept;
  /// [rt] Sample for palpate_scripted_sample().
  void scripted_sample(std::size_t hand, std::uint64_t tick_number, palpate_sample& sample) noexcept;
  /// [any] Resets faults for palpate_reset_fault().
  void reset_faults(std::uint32_t hand_bits) noexcept { resets_.fetch_or(hand_bits); }
  /// [any] Changes of tissue, noise and inclusions; the next ticks apply them.
  [[nodiscard]] palpate::haptics::ParameterUpdates& updates() noexcept { return *updates_; }
  [[nodiscard]] const palpate::haptics::ParameterUpdates& updates() const noexcept { return *updates_; }
  /// [any] Held while a caller changes the tissue, so that a change of one number keeps all others.
  [[nodiscard]] std::mutex& tissue_callers() noexcept { return tissue_callers_; }
  /// [setup] Resets the state to that before tick 0.
  void restart();
  /// [setup] Writes all rows so far to the recording, if record_waits.
  void flush_recording() {
    if (recorder_) recorder_->flush();
  }
  /// [setup] Closes the recording. @throws InputError if rows are missing from it
  void finish_recording();
  /// [any]
  [[nodiscard]] palpate_info info() const noexcept;
  /// [picture] State after the newest tick, or before the first.
  [[nodiscard]] const palpate::haptics::Snapshot& newest_snapshot() noexcept;
  /// [picture] Deforms the surface for palpate_surface_update().
  void update_surface(palpate_picture& picture);

  /// [rt] False in a child process made by fork(), which must neither use nor destroy it.
  [[nodiscard]] bool is_own() const noexcept { return process_.is_current(); }
  [[nodiscard]] std::size_t hands() const noexcept { return world_.hands(); }
  [[nodiscard]] bool recording() const noexcept { return recorder_ != nullptr; }
  [[nodiscard]] const palpate::scene::Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const palpate::haptics::SimulationWorld& world() const noexcept { return world_; }
  /// [picture] Vertices of the last update_surface().
  [[nodiscard]] const std::vector<palpate::Vec3>& vertices() const noexcept { return vertices_; }
  [[nodiscard]] const palpate::geometry::TriangleMesh& rest_surface() const noexcept {
    return deformer_.rest();
  }

 private:
  void take_samples(const palpate_sample* samples) noexcept;
  void take_update() noexcept;
  void give_result(std::size_t hand, palpate_result& result) const noexcept;
  void publish() noexcept;

  palpate::OwnProcess process_;
  palpate::scene::Scene scene_;
  std::vector<std::unique_ptr<palpate::haptics::Device>> scripted_;
  palpate::haptics::SimulationWorld world_;
  palpate::haptics::SimulationState state_;
  std::vector<palpate::haptics::DeviceState> samples_;
  std::vector<palpate::haptics::ForceCommand> commands_;  // world frame
  std::vector<palpate::haptics::TickRow> rows_;
  std::optional<palpate::haptics::ParameterUpdates> updates_;
  std::mutex tissue_callers_;
  std::uint64_t next_tick_ = 0;
  std::atomic<std::uint32_t> resets_{0};  // one bit per hand
  std::unique_ptr<palpate::record::RunRecorder> recorder_;
  palpate::TripleBuffer<palpate::haptics::Snapshot> snapshots_;
  // Used by the display thread:
  palpate::deform::SurfaceDeformer deformer_;
  std::vector<palpate::Vec3> vertices_;
};

namespace palpate::c_interface {

/// Frees a simulation, except in a child process made by fork(): there its recorder has no thread, and its
/// file is the parent's.
struct FreeOwn {
  void operator()(palpate_simulation* simulation) const noexcept {
    if (simulation->is_own()) delete simulation;
  }
};

}  // namespace palpate::c_interface
