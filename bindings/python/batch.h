#pragma once
// Many independent hands on one organ.
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/haptics/simulation.h"
#include "io/system/own_process.h"
#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/surface.h"

namespace palpate::python {

/// Independent hands, each of which touches its own copy of one organ. They share the prepared organ and the
/// tool, and each has its own contacts, gate and tick number. A hand gets the bits of a TickedSimulation
/// (no_hand=True) with the same poses, for any number of hands and threads. All calls are serialized.
class Batch final {
 public:
  /// Numbers of a pose: position x y z [m], then orientation w x y z.
  static constexpr std::size_t kPoseSize = 7;

  /// Input and results of many ticks: hands x ticks x numbers, in C order.
  struct Ticks {
    std::size_t count = 0;            // ticks per hand
    bool series = false;              // the caller's arrays have an axis of ticks: messages name the tick
    const double* poses = nullptr;    // kPoseSize numbers; in the frame of the scene's device
    const double* gripper = nullptr;  // 0 closed .. 1 open; null: closed
    double* force = nullptr;          // N, 3 numbers: on the hand, after the gate, world frame
    double* torque = nullptr;         // N m, 3 numbers: about the handle's origin
    double* depth = nullptr;          // m
    std::uint32_t* status = nullptr;  // bits of TickRow::status
    std::uint32_t* fault = nullptr;   // latched haptics::Fault
  };

  /// [setup] @param jobs most threads; empty: the cores that this program may use @param surface_edge as
  /// visible_surface() @throws InputError for a scene with several hands; InputError, ParameterError for an
  /// invalid argument
  Batch(scene::Scene scene, const contact::Preparation& how, std::size_t hands,
        std::optional<std::size_t> jobs, double surface_edge);

  /// [setup] Computes the next ticks of all hands. @throws InputError that names the first number that is not
  /// finite, quaternion that has not length 1, or gripper value outside 0 to 1; then no hand was ticked
  void step(const Ticks& ticks);

  /// [setup] Resets hands to the state before tick 0.
  void restart(std::span<const std::size_t> hands);
  /// [setup] Clears the latched faults of hands at their next tick.
  void reset_fault(std::span<const std::size_t> hands);

  /// [setup] Displacement [m, organ frame] of points of the surface at the newest tick.
  /// @param points indices of vertices of surface() @param to hands x points x 3 numbers
  void displacements(std::span<const std::size_t> points, double* to);

  /// [setup] Pressure [Pa] of the tool on points of the surface at the newest tick; negative where it pulls.
  /// @param points as displacements() @param to hands x points numbers
  void pressures(std::span<const std::size_t> points, double* to);

  [[nodiscard]] std::size_t hands() const noexcept { return hands_.size(); }
  [[nodiscard]] std::size_t jobs() const noexcept { return jobs_; }
  [[nodiscard]] const scene::Scene& scene() const noexcept { return scene_; }
  /// [any] The rest surface whose points displacements() moves.
  [[nodiscard]] const geometry::TriangleMesh& surface() const noexcept { return surface_; }

 private:
  struct Hand {
    explicit Hand(const haptics::SimulationWorld& world) : state(world) {}
    haptics::SimulationState state;
    std::uint64_t next_tick = 0;
    bool resets_fault = false;  // at the next tick
  };

  [[nodiscard]] std::unique_lock<std::mutex> lock();
  void check(const Ticks& ticks) const;
  void run(std::size_t number, const Ticks& ticks) noexcept;

  OwnProcess process_;
  std::mutex mutex_;
  scene::Scene scene_;
  geometry::TriangleMesh surface_;
  haptics::SimulationWorld world_;
  std::size_t jobs_;
  std::vector<Hand> hands_;
  std::vector<Vec3> normals_;                       // of the surface, from the first pressures() on
  std::vector<deform::SurfaceDeformer> deformers_;  // one per thread, from the first displacements() on
};

}  // namespace palpate::python
