#pragma once
// What a palpate_simulation is behind its handle.
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/haptics/simulation.h"
#include "io/record/recorder.h"
#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"
#include "palpate/triple_buffer.h"

#include "bindings/c/palpate.h"

namespace palpate::c_interface {

/// A scene that is loaded and prepared.
struct Loaded {
  scene::Scene setup;
  std::vector<std::unique_ptr<haptics::Device>> scripted;  // what palpate_scripted_sample() gives, one a hand
  haptics::SimulationWorld world;
};

/// [setup] Reads the scene and prepares the organ. @throws InputError, UseError.
[[nodiscard]] Loaded load(const palpate_options& options);

/// [setup] The same of a scene that is read already. @param no_hand as palpate_options.no_hand
[[nodiscard]] Loaded load(scene::Scene setup, const contact::Preparation& how, bool no_hand);

}  // namespace palpate::c_interface

/// One simulation of the C interface. Ticked by one thread, looked at by another.
struct palpate_simulation {
 public:
  /// [setup] @throws InputError when the recording cannot be made.
  palpate_simulation(palpate::c_interface::Loaded loaded, const palpate_options& options);

  /// [rt] The next tick; as many samples and results as hands.
  void tick(const palpate_sample* samples, palpate_result* results) noexcept;
  /// [rt] As palpate_scripted_sample().
  void scripted_sample(std::size_t hand, std::uint64_t tick_number, palpate_sample& sample) noexcept;
  /// [any] As palpate_reset_fault().
  void reset_faults(std::uint32_t hand_bits) noexcept { resets_.fetch_or(hand_bits); }
  /// [setup] Back to before tick 0.
  void restart();
  /// [setup] Ends the recording. @throws InputError when rows are missing from it.
  void finish_recording();
  /// [any]
  [[nodiscard]] palpate_info info() const noexcept;
  /// [picture] The state after the newest tick, or before the first.
  [[nodiscard]] const palpate::haptics::Snapshot& newest_snapshot() noexcept;
  /// [picture] As palpate_surface_update().
  void update_surface(palpate_picture& picture);

  [[nodiscard]] std::size_t hands() const noexcept { return world_.hands(); }
  [[nodiscard]] bool recording() const noexcept { return recorder_.has_value(); }
  [[nodiscard]] const palpate::scene::Scene& setup() const noexcept { return setup_; }
  /// [picture] As of the last update_surface().
  [[nodiscard]] const std::vector<palpate::Vec3>& vertices() const noexcept { return vertices_; }
  [[nodiscard]] const palpate::geometry::TriangleMesh& rest_surface() const noexcept {
    return deformer_.rest();
  }

 private:
  void take_samples(const palpate_sample* samples) noexcept;
  void give_result(std::size_t hand, palpate_result& result) const noexcept;
  void publish() noexcept;

  palpate::scene::Scene setup_;
  std::vector<std::unique_ptr<palpate::haptics::Device>> scripted_;
  palpate::haptics::SimulationWorld world_;
  palpate::haptics::SimulationState state_;
  std::vector<palpate::haptics::DeviceState> samples_;
  std::vector<palpate::haptics::ForceCommand> commands_;  // world frame
  std::vector<palpate::haptics::TickRow> rows_;
  std::uint64_t next_tick_ = 0;
  std::atomic<std::uint32_t> resets_{0};  // a bit a hand
  std::optional<palpate::record::Recorder> recorder_;
  palpate::TripleBuffer<palpate::haptics::Snapshot> snapshots_;
  // Of the picture's thread:
  palpate::deform::SurfaceDeformer deformer_;
  std::vector<palpate::Vec3> vertices_;
};
