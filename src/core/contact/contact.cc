#include "core/contact/contact.h"

#include <algorithm>
#include <cmath>

#include "core/contact/contact_constants.h"
#include "core/contact/load_sharing.h"
#include "core/contact/press.h"
#include "core/contact/state.h"
#include "palpate/error.h"

namespace palpate::contact {
namespace {

/// @throws InputError for a needle from a damaged file
void check_needle(const geometry::Tool& tool) {
  constexpr double kRounding = 1e-6;  // of a unit vector
  constexpr double kLargest = 1.0;    // m
  if (!tool.needle) return;
  const geometry::Needle& needle = *tool.needle;
  const auto is_length = [](double value) { return value > 0.0 && value <= kLargest; };
  if (needle.tip.allFinite() && needle.tip.norm() <= kLargest &&
      std::abs(needle.axis.norm() - 1.0) <= kRounding && is_length(needle.diameter) &&
      is_length(needle.length)) {
    return;
  }
  throw InputError(
      "tool \"" + tool.name +
      "\": its needle must have a tip within 1 m, an axis of length 1, and a diameter and a length > 0 "
      "and at most 1 m");
}

ToolPoints sample_tool(const geometry::Tool& tool) {
  check_needle(tool);
  if (tool.parts.empty() || tool.parts.size() > kMaxParts) {
    throw InputError("tool \"" + tool.name + "\" has " + std::to_string(tool.parts.size()) +
                     " parts: must be 1 to " + std::to_string(kMaxParts));
  }
  ToolPoints points;
  points.needle = tool.needle;
  double tip_z = 0.0;
  for (const geometry::ToolPart& part : tool.parts) {
    points.parts.push_back(sample_part(part, tool.tip_radius.value_or(0.0)));
    points.has_jaws = points.has_jaws || part.is_jaw;
    const PartPoints& sampled = points.parts.back();
    for (std::size_t i = 0; i < sampled.size(); ++i) {
      if (points.tip_radius > 0.0 && sampled.z[i] <= tip_z) continue;
      tip_z = sampled.z[i];
      points.tip_radius = sampled.tip_radius[i];
    }
  }
  return points;
}

std::vector<ToolPoints> sample_tools(const std::vector<geometry::Tool>& tools) {
  if (tools.empty() || tools.size() > kMaxHands) {
    throw InputError(std::to_string(tools.size()) + " tools: must be 1 to " + std::to_string(kMaxHands));
  }
  std::vector<ToolPoints> sampled;
  for (const geometry::Tool& tool : tools) sampled.push_back(sample_tool(tool));
  return sampled;
}

/// @throws InputError that names the inclusion by its number from 1
PlacedInclusion place_inclusion(const OrganSurface& surface, std::size_t index,
                                const model::Inclusion& inclusion) {
  try {
    return {surface, inclusion};
  } catch (const InputError& error) {
    throw InputError("inclusion " + std::to_string(index + 1) + ": " + error.what());
  }
}

void place_inclusions(const std::vector<model::Inclusion>& inclusions, World::Data& world) {
  if (inclusions.size() > model::kMaxInclusions) {
    throw InputError(std::to_string(inclusions.size()) + " inclusions: must be at most " +
                     std::to_string(model::kMaxInclusions));
  }
  for (std::size_t i = 0; i < inclusions.size(); ++i) {
    world.inclusions.add(place_inclusion(world.surface, i, inclusions[i]));
  }
}

/// Moves one part. @param inserted its needle is in the tissue, where no contact starts @return false when
/// the part jumped (DistanceCache::move): its contacts are dropped, and it starts none until it has been
/// outside the organ
bool move_part(const Pose& pose_S, double reference_radius, double period, bool inserted,
               PartState& part) noexcept {
  std::array<Vec3, kContactsPerPart> contacts_S;
  std::size_t count = 0;
  for (const Proxy& contact : part.active()) contacts_S[count++] = contact.load().at.point;
  const bool moved =
      inserted ? part.distances.move_inserted(pose_S, period)
               : part.distances.move(pose_S, period, std::span(contacts_S).first(count), reference_radius);
  if (!moved) {
    part.may_start_contacts = false;
    part.contact_count = 0;
  }
  if (!part.may_start_contacts && !inserted) {
    part.distances.find_nearest(kOutside);
    part.may_start_contacts = part.distances.nearest().distance >= kOutside;
  }
  return moved;
}

/// Whether the tool is a needle that enters this tissue.
bool enters(const World::Data& world, const ToolPoints& points) noexcept {
  return points.needle && !world.tissue.layers.empty();
}

/// The needle's contacts end where it goes in; new ones start only after it has left.
void puncture(const World::Data& world, const ToolPoints& points, const ToolTissue& tissue,
              ToolState& tool) noexcept {
  tool.insertion.clear_state();
  if (tool.insertion.is_inside() || !tool.insertion.try_puncture(world.surface, tissue, world.tissue.layers,
                                                                 *points.needle, tool.pose_S, tool.parts)) {
    return;
  }
  for (PartState& part : tool.parts) {
    part.contact_count = 0;
    part.may_start_contacts = false;
  }
}

/// Moves all parts of a tool and updates their contacts. Load sharing follows in advance().
std::uint32_t update_tool(const World::Data& world, const ToolPoints& points, const Pose& organ_W,
                          const ToolTissue& tissue, const ToolInput& input, ToolState& tool) noexcept {
  std::uint32_t status = 0;
  if (enters(world, points)) puncture(world, points, tissue, tool);
  tool.pose_S = organ_W.inverse() * input.pose_W;
  for (std::size_t i = 0; i < points.parts.size(); ++i) {
    PartState& part = tool.parts[i];
    const bool had_pose = part.distances.has_pose();
    if (part.gripper != input.gripper) {
      part.gripper = input.gripper;
      part.joint_T = geometry::part_pose(points.parts[i].joint, input.gripper);
    }
    if (move_part(tool.pose_S * part.joint_T, world.tissue.contact.reference_radius, world.period,
                  tool.insertion.is_inside(), part)) {
      continue;
    }
    tool.grip.release_at_once();
    tool.insertion.release_at_once();
    if (had_pose) status |= kJump;
  }
  if (tool.insertion.is_inside()) {
    tool.insertion.advance(&world.surface, tissue, world.tissue.layers, *points.needle, tool.pose_S,
                           world.period);
    return status;
  }
  if (!points.needle)
    status |= tool.grip.update(world, tissue, points, input.gripper, tool.pose_S, tool.parts);
  for (std::size_t i = 0; i < points.parts.size(); ++i) {
    status |= update_press(world, tissue, points.parts[i], tool.parts[i]);
  }
  return status;
}

/// Sums over a tool's contacts, in the organ's frame.
struct WrenchSum {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();  // about the handle's origin
  Vec3 friction = Vec3::Zero();

  void add(const Vec3& part, const Vec3& where, const Vec3& origin) noexcept {
    force += part;
    torque += (where - origin).cross(part);
  }
};

void add_view(const ContactView& view, ToolResult& result) noexcept {
  if (result.view_count < kMaxViews) result.views[static_cast<std::size_t>(result.view_count++)] = view;
}

void add_press(const Pose& organ_W, ToolState& tool, WrenchSum& sums, ToolResult& result) noexcept {
  double largest = -1.0;
  bool extrapolated = false;  // of the contact with the largest force
  for (PartState& part : tool.parts) {
    for (const Proxy& contact : part.active()) {
      const Load& load = contact.load();
      const double counts = load.share * part.press_level;
      const PressForce& force = contact.force();
      sums.add(counts * (force.normal * load.normal + force.friction + force.lateral),
               contact.application_point(), tool.pose_S.position);
      sums.friction += counts * force.friction;
      if (counts <= 0.0 || contact.depth() <= 0.0) continue;
      result.phase = Phase::kPress;
      add_view({load.at.point, -load.normal, contact.depth() * load.fade_weight * part.press_level,
                contact.patch().tip_radius, contact.patch().half_width, load.at.triangle, false,
                counts * force.normal},
               result);
      if (counts * force.normal <= largest) continue;
      largest = counts * force.normal;
      const model::ContactResponse& response = contact.response();
      result.depth = contact.depth();
      result.cutoff_layer = response.cutoff_layer;
      result.saturated = response.saturated;
      extrapolated = response.extrapolated;
      result.contact_W = organ_W * load.at.point;
      result.normal_W = organ_W.rotation * load.normal;
    }
  }
  if (extrapolated) result.status |= kExtrapolated;
}

void add_pull(const Pose& organ_W, const ToolState& tool, WrenchSum& sums, ToolResult& result) noexcept {
  const Grasp& grip = tool.grip;
  if (!grip.is_active()) return;
  const Vec3 carried = grip.anchor().point + grip.stretch();
  sums.add(grip.force(), carried, tool.pose_S.position);
  const double length = grip.stretch().norm();
  if (length > 0.0) {
    add_view({grip.anchor().point, grip.stretch() / length, length, grip.tip_radius(), 0.0,
              grip.anchor().triangle, true, grip.force().dot(grip.normal())},
             result);
  }
  result.phase = Phase::kPull;
  result.depth = length;
  result.cutoff_layer = grip.cutoff_layer();
  result.saturated = grip.saturated();
  if (grip.extrapolated()) result.status |= kExtrapolated;
  result.contact_W = organ_W * grip.anchor().point;
  result.normal_W = organ_W.rotation * grip.normal();
}

void add_needle(const Pose& organ_W, const ToolState& tool, WrenchSum& sums, ToolResult& result) noexcept {
  const NeedleInsertion& needle = tool.insertion;
  if (!needle.is_inside()) return;
  sums.force += needle.force();
  sums.torque += needle.torque();
  const double moved = needle.displacement();
  add_view({needle.entry().point, moved < 0.0 ? Vec3(-needle.direction()) : needle.direction(),
            std::abs(moved), needle.tip_radius(), needle.radius(), needle.entry().triangle, moved < 0.0},
           result);
  result.phase = Phase::kInsert;
  result.depth = std::abs(moved);
  result.cutoff_layer = needle.response().cutoff_layer;
  result.saturated = needle.response().saturated;
  if (needle.response().extrapolated) result.status |= kExtrapolated;
  if (needle.state().at_hub) result.status |= kAtHub;
  result.contact_W = organ_W * needle.entry().point;
  result.normal_W = organ_W.rotation * -needle.direction();
}

/// Exact distance of the whole tool, and the unit direction from the tissue to it.
void add_nearest(const Pose& organ_W, ToolState& tool, ToolResult& result) noexcept {
  // Begin with the part that was nearest in the last tick: its distance bounds the search in the others.
  const std::size_t first = tool.nearest_part;
  tool.parts[first].distances.find_nearest();
  for (std::size_t i = 0; i < tool.parts.size(); ++i) {
    const double best = tool.parts[tool.nearest_part].distances.nearest().distance;
    if (i == first) continue;
    tool.parts[i].distances.find_nearest(best);
    if (tool.parts[i].distances.nearest().distance < best) tool.nearest_part = i;
  }
  const DistanceCache& distances = tool.parts[tool.nearest_part].distances;
  const geometry::NearestPoint& nearest = distances.nearest();
  result.distance = nearest.distance;
  result.nearest_W = organ_W * nearest.point;
  const Vec3 to_tool = distances.point_S(distances.nearest_point()) - nearest.point;
  Vec3 away = nearest.normal;
  if (nearest.distance > kTouching) away = to_tool.normalized();
  result.away_W = organ_W.rotation * away;
  result.contact_W = result.nearest_W;
  result.normal_W = result.away_W;
}

/// Resets a result, except for the views: they are most of its memory, and only the first view_count are
/// read.
void clear(ToolResult& result) noexcept {
  result.phase = Phase::kApproach;
  result.friction = 0.0;
  result.depth = 0.0;
  result.cutoff_layer = 0;
  result.saturated = false;
  result.contact_W = Vec3::Zero();
  result.normal_W = Vec3::UnitZ();
  result.view_count = 0;
}

void summarize(const Pose& organ_W, ToolState& tool, std::uint32_t status, ToolResult& result) noexcept {
  clear(result);
  WrenchSum sums;
  result.status = status;
  add_press(organ_W, tool, sums, result);
  add_pull(organ_W, tool, sums, result);
  add_needle(organ_W, tool, sums, result);
  result.needle = tool.insertion.state();
  if (result.phase == Phase::kApproach) {
    add_nearest(organ_W, tool, result);
  } else {  // in contact, distance = -depth
    result.distance = result.phase == Phase::kPress    ? -result.depth
                      : result.phase == Phase::kInsert ? -tool.insertion.way()
                                                       : 0.0;
    result.nearest_W = result.contact_W;
    result.away_W = result.normal_W;
  }
  result.force_W = organ_W.rotation * sums.force;
  result.torque_W = organ_W.rotation * sums.torque;
  result.friction = sums.friction.norm();
}

void set_size_factors(const World::Data& world, const TissueLaws& laws, State::Data& state) noexcept {
  for (std::size_t t = 0; t < state.tools.size(); ++t) {
    state.tools[t].size_factor = laws.size_factor(world.tools[t].tip_radius);
  }
}

}  // namespace

World::World(const geometry::TriangleMesh& organ, const std::vector<geometry::Tool>& tools,
             const model::TissueParameters& tissue, double loop_period, const Preparation& how,
             const model::TissueVariation& variation, const DistanceOf& distance_of) {
  model::validate(tissue);
  const double reference_radius = tissue.contact.reference_radius;
  auto data = std::make_unique<Data>(Data{tissue, OrganSurface(organ, reference_radius, how, distance_of),
                                          sample_tools(tools), TissueLaws(tissue, loop_period), loop_period});
  if (!variation.stiffness.empty()) {
    data->map = StiffnessMap(data->surface, variation.stiffness, how.store.get());
  }
  place_inclusions(variation.inclusions, *data);
  data_ = std::move(data);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::size_t World::tool_count() const noexcept { return data_->tools.size(); }
const model::TissueParameters& World::tissue() const noexcept { return data_->tissue; }
const model::SpringLaw& World::press_law() const noexcept { return data_->laws.press; }
const model::SpringLaw& World::pull_law() const noexcept { return data_->laws.pull; }
const geometry::TriangleMesh& World::rest_surface() const noexcept { return data_->surface.mesh(); }
const geometry::SignedDistance& World::rest_distance() const noexcept { return data_->surface.distance(); }
bool World::has_needle() const noexcept {
  return std::any_of(data_->tools.begin(), data_->tools.end(),
                     [](const ToolPoints& tool) { return tool.needle.has_value(); });
}
std::vector<model::Inclusion> World::inclusions() const {
  std::vector<model::Inclusion> inclusions;
  for (const PlacedInclusion& one : data_->inclusions.at_rest()) inclusions.push_back(one.inclusion);
  return inclusions;
}
double tip_radius_of(const geometry::Tool& tool) { return sample_tool(tool).tip_radius; }
double World::tip_radius(std::size_t tool) const noexcept { return data_->tools[tool].tip_radius; }

State::State(const World& world) : data_(std::make_unique<Data>()) {
  data_->inclusions = world.data().inclusions;
  for (const ToolPoints& points : world.data().tools) {
    ToolState tool;
    for (const PartPoints& part : points.parts) tool.parts.emplace_back(world.data().surface, part);
    data_->tools.push_back(std::move(tool));
  }
  set_size_factors(world.data(), world.data().laws, *data_);
}
State::~State() = default;
State::State(const State& other) : data_(std::make_unique<Data>(*other.data_)) {}
State& State::operator=(const State& other) {
  if (this != &other) data_ = std::make_unique<Data>(*other.data_);
  return *this;
}
State::State(State&&) noexcept = default;
State& State::operator=(State&&) noexcept = default;

void change_tissue(const World& world, State& state, const TissueLaws& laws) noexcept {
  State::Data& now = state.data();
  set_size_factors(world.data(), laws, now);
  const model::Relaxation before = now.laws(world.data()).relaxation;
  for (ToolState& tool : now.tools) {
    for (PartState& part : tool.parts) {
      for (Proxy& contact : part.active()) laws.relaxation.convert_history(contact.load().memory, before);
    }
    tool.grip.change_relaxation(laws.relaxation, before);
    tool.insertion.change_relaxation(laws.relaxation, before);
  }
  now.updated_laws = laws;
}

PlacedInclusion placed_inclusion(const World& world, std::size_t index, const model::Inclusion& inclusion) {
  return place_inclusion(world.data().surface, index, inclusion);
}

void change_inclusion(State& state, std::size_t index, const PlacedInclusion& placed) noexcept {
  state.data().inclusions.replace(index, placed);
}

void move_inclusions(State& state, double time) noexcept { state.data().inclusions.move_to(time); }

void advance(const World& world, const Pose& organ_W, std::span<const ToolInput> inputs, State& state,
             std::span<ToolResult> results) noexcept {
  const World::Data& data = world.data();
  State::Data& now = state.data();
  const TissueLaws& laws = now.laws(data);
  std::array<std::uint32_t, kMaxHands> status{};
  std::array<Load*, kMaxContacts> all;  // the first `count` are used
  std::size_t count = 0;
  for (std::size_t t = 0; t < data.tools.size(); ++t) {
    const ToolTissue tissue{laws, now.inclusions.now(), data.map, data.tools[t].tip_radius,
                            now.tools[t].size_factor};
    status[t] = update_tool(data, data.tools[t], organ_W, tissue, inputs[t], now.tools[t]);
    for (PartState& part : now.tools[t].parts) {
      for (Proxy& contact : part.active()) all[count++] = &contact.load();
    }
  }
  share_load(data.tissue.contact.reference_radius, std::span(all).first(count));
  for (std::size_t t = 0; t < data.tools.size(); ++t) {
    summarize(organ_W, now.tools[t], status[t], results[t]);
  }
}

}  // namespace palpate::contact
