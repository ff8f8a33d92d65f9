#include "learning/environment/environment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/haptics/prepared_update.h"
#include "io/scene/make_world.h"
#include "io/scene/organ_distance.h"
#include "io/scene/search.h"
#include "palpate/error.h"
#include "palpate/tool_path.h"
#include "palpate/units.h"

namespace palpate::learning {
namespace {

constexpr double kFastest = 0.1;           // m/s, of the hand
constexpr Range kTargets{0.2, 0.8};        // N
constexpr std::uint32_t kEpisodePart = 0;  // part of the random numbers
constexpr double kInfinite = std::numeric_limits<double>::infinity();

void require_count(const char* name, std::uint64_t value, std::uint64_t most, std::uint64_t least = 1) {
  if (value >= least && value <= most) return;
  throw InputError(fmt::format("{} = {}: must be {} to {}", name, value, least, most));
}

void require_range(const char* name, const Range& range, double least, double most, const char* unit) {
  if (range.low >= least && range.low <= range.high && range.high <= most) return;
  throw InputError(fmt::format("{} = {} to {}: must be ascending, within {} to {}{}", name,
                               shortest(range.low), shortest(range.high), shortest(least), shortest(most),
                               unit));
}

const Settings& checked(const Settings& settings) {
  constexpr double kMaxNoise = 1.0;  // N m; the scene's own limit of sigma is lower
  require_count("ticks", settings.ticks, 1000);
  require_count("steps", settings.steps, 1'000'000);
  require_count("surface_points", settings.surface_points, 10'000, 0);
  require_range("tolerance", {settings.tolerance, settings.tolerance}, 1e-4, 1.0, " m");
  require_range("stiffness_factor", settings.stiffness_factor, 0.01, 100.0, "");
  if (settings.noise_gain) require_range("noise_gain", *settings.noise_gain, 0.0, kMaxNoise, " N m");
  require_range("start_offset", {settings.start_offset, settings.start_offset}, 0.0, 1.0, " m");
  return settings;
}

/// The part of the scene that the task uses: it presses, and a search has one lump.
scene::Scene adapted(scene::Scene scene, Task task) {
  if (task == Task::kInsert) {
    if (scene.task == scene::Task::kInsert && !scene.target.layer.empty()) return scene;
    throw InputError("insert: the scene has no layer to reach, must have task insert and [target] layer");
  }
  scene.task = scene::Task::kPress;
  if (task != Task::kSearch) return scene;
  if (scene.inclusions.empty()) {
    throw InputError("search: the scene has no inclusion to find, must have one (such as nodule)");
  }
  scene.inclusions.resize(1);
  return scene;
}

/// Puts the hands where their paths start and replaces the devices by ones in the world frame. @param
/// approach receives the direction in which the first tool meets the organ
std::vector<haptics::DeviceState> take_hands(scene::Scene& scene, Vec3& approach) {
  std::vector<haptics::DeviceState> start;
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    scene::DeviceSetup& device = scene.devices[hand];
    const bool has_path = device.kind == "scripted" && !device.path.empty();
    const scene::PathRow row =
        (has_path ? scene::read_tool_path(device.path) : scene::default_path(scene, hand)).rows().front();
    const Pose pose_W =
        haptics::WorkspaceMapping{device.workspace_scale, device.base}.apply(row.position, row.orientation);
    haptics::DeviceState& state = start.emplace_back();
    state.position_D = pose_W.position;
    state.orientation_D = pose_W.rotation;
    state.gripper = row.gripper;
    if (hand == 0 && !has_path) approach = pose_W.rotation * Vec3::UnitZ();  // a default path moves along +z
  }
  scene.devices.assign(scene.devices.size(), {});
  return start;
}

/// Centres for the lump, as deep below the upper side as the scene's. @throws InputError when the organ has
/// no place
std::vector<Vec3> lump_places_of(const scene::Scene& scene) {
  const geometry::SignedDistance surface = scene::organ_distance_of(scene);
  const scene::SearchArea area(scene.organ, surface, scene.organ_pose);
  const model::Inclusion& lump = scene.inclusions.front().inclusion;
  const double depth = -surface.nearest(lump.centre_S).distance;
  std::vector<Vec3> places;
  for (const std::int32_t t : area.triangles()) {
    const geometry::Triangle& corners = scene.organ.triangles[static_cast<std::size_t>(t)];
    Vec3 centre = -depth * geometry::area_vector_doubled(scene.organ, corners).normalized();
    for (const std::int32_t v : corners) centre += scene.organ.vertices[static_cast<std::size_t>(v)] / 3.0;
    const geometry::NearestPoint above = surface.nearest(centre);
    if (-above.distance >= lump.radius + lump.pulse && area.contains(above.triangle))
      places.push_back(centre);
  }
  if (places.empty()) throw InputError("search: the organ has no place for the lump under its upper side");
  return places;
}

}  // namespace

const char* to_string(Task task) noexcept {
  return task == Task::kPress    ? "press"
         : task == Task::kHold   ? "hold"
         : task == Task::kSearch ? "search"
                                 : "insert";
}

Task parse_task(const std::string& text) {
  for (const Task task : {Task::kPress, Task::kHold, Task::kSearch, Task::kInsert}) {
    if (text == to_string(task)) return task;
  }
  throw InputError("task: " + one_line(text) + " is not press, hold, search or insert");
}

scene::Overrides with_defaults(Task task, scene::Overrides request) {
  if (request.scene || request.scene_text) return request;
  if (task == Task::kInsert) {
    request.scene_text = {
        "[scene]\ntask = \"insert\"\n[organ]\nmesh = \"box\"\ntissue = \"vein\"\n[target]\nlayer = "
        "\"lumen\"\n"
        "forbidden = [\"far wall\"]\n[tool]\nmesh = \"needle\"\n",
        {}};
    return request;
  }
  if (!request.organ) request.organ = "liver";
  if (request.tools.empty()) request.tools = {"sphere:5"};
  if (task == Task::kHold && request.organ_motion.empty()) request.organ_motion = {"breathing"};
  if (task == Task::kSearch && request.inclusions.empty()) request.inclusions = {"nodule"};
  return request;
}

Environment::Common::Common(scene::Scene loaded, const Settings& given, const contact::Preparation& how)
    : settings(checked(given)),
      scene(adapted(std::move(loaded), given.task)),
      start(take_hands(scene, approach)),
      world(scene::make_world(scene, how)),
      limit(kFastest * static_cast<double>(given.ticks) / scene.rate_Hz) {
  if (settings.task == Task::kSearch) lump_places_S = lump_places_of(scene);
  if (settings.surface_points > 0)
    response = deform::prepare_response(scene.organ, scene.support, how.store.get());
  list_channels();
}

Environment::Environment(scene::Scene scene, const Settings& settings, const contact::Preparation& how)
    : Environment(std::make_shared<const Common>(std::move(scene), settings, how)) {
  // Rejects now what the bounds of a range would make of the tissue and the noise.
  for (const bool high : {false, true}) {
    noise::NoiseSettings noise = common_->world.noise.settings();
    if (settings.noise_gain) noise.gain = high ? settings.noise_gain->high : settings.noise_gain->low;
    start_state(high ? settings.stiffness_factor.high : settings.stiffness_factor.low, noise);
  }
}

Environment::Environment(std::shared_ptr<const Common> common)
    : common_(std::move(common)),
      state_(common_->world),
      samples_(common_->world.hands()),
      commands_(common_->world.hands()),
      rows_(common_->world.hands()),
      random_(0, 0, kEpisodePart) {
  if (common_->settings.task == Task::kSearch) lump_S_ = common_->lump_places_S.front();
  if (common_->settings.surface_points > 0) deformer_.emplace(common_->scene.organ, common_->response);
}

void Environment::Common::list_channels() {
  for (const char* name : {"dx", "dy", "dz"}) acted.push_back({name, "m", -limit, limit});
  for (const char* name : {"x", "y", "z"}) observed.push_back({name, "m", -kInfinite, kInfinite});
  observed.push_back({"depth", "m", 0.0, kInfinite});
  observed.push_back({"distance", "m", -kInfinite, kInfinite});
  const double most = scene.safety.max_force;
  for (const char* name : {"force_x", "force_y", "force_z"}) observed.push_back({name, "N", -most, most});
  observed.push_back({"target", "N", 0.0, most});
  if (settings.task == Task::kInsert) observed.push_back({"inserted", "m", 0.0, kInfinite});
  for (std::uint64_t i = 0; i < settings.surface_points; ++i) {
    observed.push_back({"displacement_" + std::to_string(i), "m", 0.0, kInfinite});
  }
  drawn.push_back({"stiffness_factor", "1", settings.stiffness_factor.low, settings.stiffness_factor.high});
  const double noise = scene.noise.enabled ? scene.noise.gain : 0.0;
  const Range gain = settings.noise_gain.value_or(Range{noise, noise});
  drawn.push_back({"noise_gain", "N m", gain.low, gain.high});
  for (const char* name : {"start_x", "start_y"}) {
    drawn.push_back({name, "m", -settings.start_offset, settings.start_offset});
  }
  if (settings.task == Task::kInsert) return;
  if (settings.task != Task::kSearch) {
    drawn.push_back({"target", "N", kTargets.low, kTargets.high});
    return;
  }
  acted.push_back({"mark", "1", 0.0, 1.0});
  for (const char* name : {"lump_x", "lump_y", "lump_z"}) {
    drawn.push_back({name, "m", -kInfinite, kInfinite});
  }
}

double Environment::draw(const Range& range) noexcept {
  const double share = random_.uniform();  // drawn also for a constant, so that ranges do not change others
  return range.low + share * (range.high - range.low);
}

/// The state before tick 0, with the tissue, noise and lump of an episode.
void Environment::start_state(double stiffness_factor, const noise::NoiseSettings& noise) {
  state_ = haptics::SimulationState(common_->world);
  state_.touch_noise = noise::TouchNoise(noise, common_->world.rate_Hz);
  state_.noise_enabled = noise.enabled;
  model::TissueParameters tissue = common_->scene.tissue;
  tissue.k1 *= stiffness_factor;
  haptics::ParameterUpdate update = haptics::parameter_update(
      tissue, {noise.enabled, noise.gain, noise.threshold}, haptics::kTissueChanged);
  if (common_->settings.task == Task::kSearch) {
    update.what |= haptics::kInclusionChanged;
    update.inclusion = {
        0, {lump_S_.x(), lump_S_.y(), lump_S_.z()}, common_->scene.inclusions.front().inclusion.ratio};
  }
  haptics::apply_update(common_->world, state_, haptics::prepare_update(common_->world, update));
}

StepResult Environment::reset(std::optional<std::uint64_t> seed) {
  if (seed) random_ = Random(*seed, 0, kEpisodePart);
  const double factor = draw(common_->settings.stiffness_factor);
  noise::NoiseSettings noise = common_->world.noise.settings();
  noise.gain = draw(common_->settings.noise_gain.value_or(Range{noise.gain, noise.gain}));
  noise.enabled = noise.enabled || common_->settings.noise_gain;
  noise.seed = random_.below(std::size_t{1} << 53);
  const Range offset{-common_->settings.start_offset, common_->settings.start_offset};
  const Vec3 moved(draw(offset), draw(offset), 0.0);
  parameters_ = {factor, noise.enabled ? noise.gain : 0.0, moved.x(), moved.y()};
  if (common_->settings.task == Task::kSearch) {
    lump_S_ = common_->lump_places_S[random_.below(common_->lump_places_S.size())];
    const Vec3 lump = common_->scene.organ_pose * lump_S_ - start();
    parameters_.insert(parameters_.end(), {lump.x(), lump.y(), lump.z()});
  } else if (common_->settings.task != Task::kInsert) {
    target_ = draw(kTargets);
    parameters_.push_back(target_);
  }
  start_state(factor, noise);
  position_ = start() + moved;
  tick_ = step_ = layer_ = 0;
  finished_ = in_target_ = in_forbidden_ = false;
  return move(Vec3::Zero());
}

StepResult Environment::move(const Vec3& change) {
  const auto ticks = static_cast<double>(common_->settings.ticks);
  samples_ = common_->start;
  samples_.front().velocity_D = change * (common_->world.rate_Hz / ticks);
  for (std::uint64_t i = 1; i <= common_->settings.ticks; ++i) {
    samples_.front().position_D = position_ + (static_cast<double>(i) / ticks) * change;
    haptics::tick(common_->world, state_, tick_++, samples_, commands_, rows_);
    if (common_->settings.task == Task::kInsert) watch_layers(rows_.front());
  }
  position_ += change;
  const haptics::TickRow& row = rows_.front();
  const Vec3 moved = position_ - start();
  observation_ = {moved.x(),    moved.y(),    moved.z(),    row.depth, row.distance,
                  row.force[0], row.force[1], row.force[2], target_};
  if (common_->settings.task == Task::kInsert) observation_.push_back(row.inserted_mm * kMillimetre);
  if (deformer_) {
    const std::vector<Vec3>& rest = deformer_->rest().vertices;
    deformer_->deform(state_.reach, deform::indentations_of(state_.results), vertices_);
    const std::size_t gaps = std::max<std::size_t>(common_->settings.surface_points, 2) - 1;
    for (std::size_t i = 0; i < common_->settings.surface_points; ++i) {
      const std::size_t vertex = i * (rest.size() - 1) / gaps;  // evenly numbered, from the first to the last
      observation_.push_back((vertices_[vertex] - rest[vertex]).norm());
    }
  }
  return {0.0, false, false, row.tissue_force, row.tick, row.fault};
}

/// Also of layers that the tip crosses within a tick.
void Environment::watch_layers(const haptics::TickRow& row) {
  const std::vector<model::TissueLayer>& layers = common_->scene.tissue.layers;
  const scene::TargetSetup& target = common_->scene.target;
  for (std::uint64_t i = layer_; i < row.layer; ++i) {
    in_forbidden_ = in_forbidden_ || std::find(target.forbidden.begin(), target.forbidden.end(),
                                               layers[i].name) != target.forbidden.end();
  }
  layer_ = row.layer;
  in_target_ = layer_ > 0 && layers[layer_ - 1].name == target.layer;
}

/// Reward of a mark at the tool.
double Environment::judge_mark(bool& terminated) const {
  const Vec3 away = position_ - state_.organ_W * lump_S_;
  terminated =
      away.x() * away.x() + away.y() * away.y() <= common_->settings.tolerance * common_->settings.tolerance;
  return terminated ? 1.0 : -0.1;
}

StepResult Environment::step(std::span<const double> action) {
  if (finished_) throw std::logic_error("Env.step: the episode has ended, call reset() first");
  const bool finite =
      std::all_of(action.begin(), action.end(), [](double value) { return std::isfinite(value); });
  if (action.size() != common_->acted.size() || !finite) {
    std::vector<std::string> given, names;
    for (const double value : action) given.push_back(shortest(value));
    for (const Channel& channel : common_->acted) names.push_back(channel.name);
    throw InputError(fmt::format("action: [{}], must be {} finite numbers: {}", joined(given), names.size(),
                                 joined(names)));
  }
  Vec3 change(action[0], action[1], action[2]);
  if (const double length = change.norm(); length > common_->limit) change *= common_->limit / length;
  StepResult result = move(change);
  if (common_->settings.task == Task::kInsert) {
    result.terminated = in_forbidden_;
    result.reward = in_forbidden_ ? -1.0 : in_target_ ? 1.0 : 0.0;
  } else if (common_->settings.task != Task::kSearch) {
    result.reward = -std::abs(result.tissue_force - target_) / target_;
  } else if (action[3] > 0.5) {
    result.reward = judge_mark(result.terminated);
  }
  result.truncated = ++step_ >= common_->settings.steps && !result.terminated;
  finished_ = result.terminated || result.truncated;
  return result;
}

}  // namespace palpate::learning
