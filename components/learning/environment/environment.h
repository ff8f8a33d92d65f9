#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/haptics/simulation.h"
#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "palpate/surface.h"

namespace palpate::learning {

enum class Task : std::uint8_t {
  kPress,   // reach a force
  kHold,    // keep a force while the organ moves
  kSearch,  // find a hidden lump
  kInsert,  // bring a needle's tip into a layer, and not into forbidden ones
};

/// [any] "press", "hold", "search" or "insert".
[[nodiscard]] const char* to_string(Task task) noexcept;
/// [setup] @throws InputError that names the text and the tasks
[[nodiscard]] Task parse_task(const std::string& text);

/// A uniform distribution; equal bounds give a constant.
struct Range {
  double low = 0.0;
  double high = 0.0;
};

/// Settings of an environment. The ranges are for domain randomisation: each episode draws from them.
struct Settings {
  Task task = Task::kPress;
  std::uint64_t steps = 500;          // after these an episode is truncated
  std::uint64_t ticks = 10;           // haptic ticks per step
  double tolerance = 10e-3;           // m, horizontal distance within which a mark finds the lump
  std::uint64_t surface_points = 0;   // of the surface, whose displacements are observed
  Range stiffness_factor{1.0, 1.0};   // of the tissue's k1
  std::optional<Range> noise_gain{};  // K of the touch noise [N m]; empty: as the scene says
  double start_offset = 0.0;          // m, largest offset of the start along x and along y
};

/// A number of an observation, of an action or of an episode's parameters.
struct Channel {
  std::string name;
  std::string unit;  // SI; "1": dimensionless
  double low = 0.0;  // bounds, possibly infinite
  double high = 0.0;
};

/// Result of a step. The observation is Environment::observation().
struct StepResult {
  double reward = 0.0;
  bool terminated = false;    // the lump is found, or a forbidden layer entered
  bool truncated = false;     // the steps are used up
  double tissue_force = 0.0;  // N, norm
  std::uint64_t tick = 0;     // of the last row
  std::uint32_t fault = 0;    // haptics::Fault
};

/// [setup] The scene of a task: without a scene file, a ball of 5 mm over the liver, which breathes in kHold
/// and has a nodule in kSearch; in kInsert a needle over a block with the tissue vein, whose lumen is the
/// target and whose far wall is forbidden. Values of the request are kept.
[[nodiscard]] scene::Overrides with_defaults(Task task, scene::Overrides request);

/// A task for reinforcement learning: one hand presses an organ. Observations, rewards and random numbers are
/// a function of settings, scene, seed and actions, bit for bit.
///
/// Action: the change of the tool's position [m], world frame, at most 0.1 m/s; in kSearch then a mark, above
/// 0.5 at the lump. Observation: position from the scene's start, depth, distance, force on the tool, target
/// (0 in kSearch and kInsert), in kInsert the length of the needle inside, and the displacements of surface
/// points. Reward: -|F - target| / target; in kSearch 1 for a mark that finds the lump and -0.1 for another;
/// in kInsert 1 for a step that ends with the tip in the target's layer and -1 for one in which it enters a
/// forbidden layer, which ends the episode. Other hands of the scene stay where they start.
class Environment final {
 public:
  /// [setup] @throws InputError, ParameterError that name the setting or the part of the scene
  Environment(scene::Scene scene, const Settings& settings, const contact::Preparation& how = {});
  /// [setup] Another environment of the same scene and settings, before its first reset(). Both share the
  /// prepared organ, and may be used by two threads.
  [[nodiscard]] Environment another() const { return Environment(common_); }

  /// [setup] Starts an episode. @param seed empty: the random numbers go on
  StepResult reset(std::optional<std::uint64_t> seed);
  /// [setup] @throws InputError for another number of values, or one that is not finite; std::logic_error
  /// after the end of an episode
  StepResult step(std::span<const double> action);

  /// [any] Values of the channels; of the last reset() or step().
  [[nodiscard]] std::span<const double> observation() const noexcept { return observation_; }
  [[nodiscard]] std::span<const double> parameters() const noexcept { return parameters_; }
  [[nodiscard]] std::span<const Channel> observation_channels() const noexcept { return common_->observed; }
  [[nodiscard]] std::span<const Channel> action_channels() const noexcept { return common_->acted; }
  /// [any] What an episode draws: stiffness factor, noise gain, start, then the target or the lump's centre
  /// at rest; positions from the scene's start.
  [[nodiscard]] std::span<const Channel> parameter_channels() const noexcept { return common_->drawn; }

  [[nodiscard]] const Settings& settings() const noexcept { return common_->settings; }
  [[nodiscard]] const scene::Scene& scene() const noexcept { return common_->scene; }
  [[nodiscard]] double step_limit() const noexcept { return common_->limit; }  // m
  /// [any] Where the tool starts, and the direction in which it meets the organ, world frame.
  [[nodiscard]] const Vec3& start() const noexcept { return common_->start.front().position_D; }
  [[nodiscard]] const Vec3& approach() const noexcept { return common_->approach; }

 private:
  /// What environments share; constant.
  struct Common {
    Common(scene::Scene loaded, const Settings& given, const contact::Preparation& how);
    void list_channels();

    Settings settings;
    scene::Scene scene;
    Vec3 approach = -Vec3::UnitZ();
    std::vector<haptics::DeviceState> start;  // per hand; the device frame is the world frame
    haptics::SimulationWorld world;
    std::vector<Vec3> lump_places_S;  // in kSearch
    std::vector<Channel> observed, acted, drawn;
    double limit = 0.0;                                     // m, largest change of a step
    std::shared_ptr<const deform::OrganResponse> response;  // with surface points, of a supported organ
  };

  explicit Environment(std::shared_ptr<const Common> common);
  void start_state(double stiffness_factor, const noise::NoiseSettings& noise);
  double draw(const Range& range) noexcept;
  StepResult move(const Vec3& change);
  [[nodiscard]] double judge_mark(bool& terminated) const;
  void watch_layers(const haptics::TickRow& row);

  std::shared_ptr<const Common> common_;
  haptics::SimulationState state_;
  std::vector<haptics::DeviceState> samples_;
  std::vector<haptics::ForceCommand> commands_;
  std::vector<haptics::TickRow> rows_;
  std::optional<deform::SurfaceDeformer> deformer_;  // only with surface points
  std::vector<Vec3> vertices_;

  Random random_;
  Vec3 position_ = Vec3::Zero();
  Vec3 lump_S_ = Vec3::Zero();
  double target_ = 0.0;      // N
  std::uint64_t layer_ = 0;  // of the tip, from 1
  bool in_target_ = false;
  bool in_forbidden_ = false;  // since the start of the episode
  std::vector<double> observation_, parameters_;
  std::uint64_t tick_ = 0;
  std::uint64_t step_ = 0;
  bool finished_ = true;
};

}  // namespace palpate::learning
