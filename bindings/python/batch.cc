#include "bindings/python/batch.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/deform/half_space.h"
#include "core/deform/surface_parts.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"

#include "bindings/c/simulation.h"
#include "bindings/python/on_threads.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

constexpr std::size_t kMaxHandsOfBatch = 1'000'000;

std::size_t checked_hands(std::size_t hands) {
  if (hands >= 1 && hands <= kMaxHandsOfBatch) return hands;
  throw InputError(fmt::format("n = {}: must be 1 to {} hands", hands, kMaxHandsOfBatch));
}

/// The scene of one hand whose device nobody holds, with its remarks.
scene::Scene prepared(scene::Scene scene) {
  if (scene.tools.size() != 1) {
    throw InputError(fmt::format("the scene has {} hands: must have one, of which Batch makes n copies",
                                 scene.tools.size()));
  }
  scene.devices.front().kind = scene::DeviceSetup{}.kind;
  for (std::string& remark : scene::overlap_remarks(scene)) scene.remarks.push_back(std::move(remark));
  return scene;
}

/// "poses[3, 12, 4]", without the tick where the array has no axis of ticks.
std::string place(const char* array, const Batch::Ticks& ticks, std::size_t row, const std::string& entry) {
  const std::string tick = ticks.series ? fmt::format(", {}", row % ticks.count) : "";
  return fmt::format("{}[{}{}{}]", array, row / ticks.count, tick, entry);
}

}  // namespace

Batch::Batch(scene::Scene scene, const contact::Preparation& how, std::size_t hands,
             std::optional<std::size_t> jobs, double surface_edge)
    : scene_(prepared(std::move(scene))),
      surface_(visible_surface(scene_, surface_edge)),
      world_(scene::make_world(scene_, how)),
      jobs_(threads_for(jobs, checked_hands(hands))),
      hands_(hands, Hand(world_)) {
  scene_.store = how.store;
}

std::unique_lock<std::mutex> Batch::lock() {
  if (!process_.is_current()) throw std::logic_error(c_interface::kForked);
  return std::unique_lock(mutex_);
}

void Batch::check(const Ticks& ticks) const {
  for (std::size_t row = 0; row < hands_.size() * ticks.count; ++row) {
    const std::span pose(ticks.poses + row * kPoseSize, kPoseSize);
    const double norm = Quat(pose[3], pose[4], pose[5], pose[6]).norm();
    if (std::abs(norm - 1.0) <= haptics::kQuaternionSlack && std::isfinite(pose[0] + pose[1] + pose[2]))
      continue;
    for (std::size_t i = 0; i < kPoseSize; ++i) {
      if (std::isfinite(pose[i])) continue;
      throw InputError(place("poses", ticks, row, fmt::format(", {}", i)) + " = " + shortest(pose[i]) +
                       ": must be finite");
    }
    if (std::abs(norm - 1.0) <= haptics::kQuaternionSlack)
      continue;  // a sum of finite numbers that overflows
    throw InputError(fmt::format("{} = [{}, {}, {}, {}]: must be a quaternion w x y z of length 1, has {}",
                                 place("poses", ticks, row, ", 3:7"), shortest(pose[3]), shortest(pose[4]),
                                 shortest(pose[5]), shortest(pose[6]), shortest(norm)));
  }
  if (ticks.gripper == nullptr) return;
  for (std::size_t row = 0; row < hands_.size() * ticks.count; ++row) {
    const double opening = ticks.gripper[row];
    if (opening >= 0.0 && opening <= 1.0) continue;
    throw InputError(place("gripper", ticks, row, "") + " = " + shortest(opening) +
                     ": must be 0 (closed) to 1 (open)");
  }
}

/// Computes all ticks of one hand.
void Batch::run(std::size_t number, const Ticks& ticks) noexcept {
  Hand& hand = hands_[number];
  haptics::DeviceState sample;
  haptics::ForceCommand command;
  haptics::TickRow row;
  if (std::exchange(hand.resets_fault, false)) sample.events = haptics::kResetFault;
  for (std::size_t i = number * ticks.count; i < (number + 1) * ticks.count; ++i) {
    const double* pose = ticks.poses + i * kPoseSize;
    sample.position_D = Vec3(pose[0], pose[1], pose[2]);
    sample.orientation_D = Quat(pose[3], pose[4], pose[5], pose[6]);
    if (ticks.gripper != nullptr) sample.gripper = ticks.gripper[i];
    haptics::tick(world_, hand.state, hand.next_tick++, {&sample, 1}, {&command, 1}, {&row, 1});
    sample.events = 0;
    std::copy(row.force.begin(), row.force.end(), ticks.force + 3 * i);
    std::copy(row.torque.begin(), row.torque.end(), ticks.torque + 3 * i);
    ticks.depth[i] = row.depth;
    ticks.status[i] = row.status;
    ticks.fault[i] = row.fault;
  }
}

void Batch::step(const Ticks& ticks) {
  const auto locked = lock();
  check(ticks);
  on_threads(jobs_, hands_.size(), [&](std::size_t, std::size_t hand) { run(hand, ticks); });
}

void Batch::restart(std::span<const std::size_t> hands) {
  const auto locked = lock();
  const Hand fresh(world_);
  for (const std::size_t hand : hands) hands_[hand] = fresh;
}

void Batch::reset_fault(std::span<const std::size_t> hands) {
  const auto locked = lock();
  for (const std::size_t hand : hands) hands_[hand].resets_fault = true;
}

void Batch::displacements(std::span<const std::size_t> points, double* to) {
  const auto locked = lock();
  if (deformers_.empty()) {
    const auto response = deform::prepare_response(scene_.organ, scene_.support, scene_.store.get());
    while (deformers_.size() < jobs_) deformers_.emplace_back(surface_, response);
  }
  std::vector<std::vector<Vec3>> moved(jobs_);
  on_threads(jobs_, hands_.size(), [&](std::size_t thread, std::size_t hand) {
    const haptics::SimulationState& state = hands_[hand].state;
    deformers_[thread].deform(state.reach, deform::indentations_of(state.results), moved[thread]);
    double* number = to + hand * points.size() * 3;
    for (const std::size_t point : points) {
      const Vec3 way = moved[thread][point] - surface_.vertices[point];
      number = std::copy(way.data(), way.data() + 3, number);
    }
  });
}

// The law gives the force of a contact and not how it spreads. It is spread as under a ball on a half-space,
// whose contact is as wide as the dent that is drawn.
void Batch::pressures(std::span<const std::size_t> points, double* to) {
  const auto locked = lock();
  if (normals_.empty()) normals_ = deform::vertex_normals(surface_);
  on_threads(jobs_, hands_.size(), [&](std::size_t, std::size_t hand) {
    double* const pressure = to + hand * points.size();
    std::fill(pressure, pressure + points.size(), 0.0);
    for (const contact::ToolResult& result : hands_[hand].state.results) {
      for (const contact::ContactView& view :
           std::span(result.views).first(static_cast<std::size_t>(result.view_count))) {
        double radius = deform::ball_contact_radius(view.radius(), view.depth);
        if (view.pull) radius = std::max(radius, deform::kHeldWide * view.radius());
        const Vec3 outward = view.force < 0.0 ? view.direction_S : Vec3(-view.direction_S);
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double r = (surface_.vertices[points[i]] - view.point_S).norm();
          if (normals_[points[i]].dot(outward) > 0.0)
            pressure[i] += view.force * deform::contact_pressure(r, radius);
        }
      }
    }
  });
}

}  // namespace palpate::python
