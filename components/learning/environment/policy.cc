#include "learning/environment/policy.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "io/scene/plausibility.h"
#include "palpate/error.h"
#include "palpate/tool_path.h"

namespace palpate::learning {
namespace {

constexpr std::uint32_t kActionPart = 1;  // part of the random numbers; an environment's is 0

Vec3 moved(const Environment& environment) {
  const std::span<const double> seen = environment.observation();
  return {seen[0], seen[1], seen[2]};
}

void put_change(const Environment& environment, Vec3 change, std::span<double> action) {
  if (const double length = change.norm(); length > environment.step_limit())
    change *= environment.step_limit() / length;
  std::copy(change.begin(), change.end(), action.begin());
}

class RandomWalk final : public Policy {
 public:
  RandomWalk(const Environment& environment, std::uint64_t seed)
      : environment_(environment), random_(seed, 0, kActionPart) {
    constexpr double kAside = 15e-3;  // m
    constexpr double kDown = 20e-3;   // m; a default path starts 10 mm above the organ
    constexpr double kUp = 5e-3;      // m
    low_ = Vec3(-kAside, -kAside, -kDown);
    high_ = Vec3(kAside, kAside, kUp);
    if (environment.settings().task != Task::kSearch) return;
    const geometry::Bounds box = scene::organ_box(environment.scene());
    low_.head<2>() = (box.low - environment.start()).head<2>();
    high_.head<2>() = (box.high - environment.start()).head<2>();
  }

  void act(const StepResult& /*last*/, std::span<double> action) override {
    constexpr double kKept = 0.9;     // of the last change
    constexpr double kSpread = 0.25;  // of the largest change
    constexpr double kMarks = 0.01;   // share of steps with a mark
    const Vec3 at = moved(environment_);
    for (int i = 0; i < 3; ++i) {
      double& change = change_(i);
      change = kKept * change + kSpread * environment_.step_limit() * random_.normal();
      if (at(i) + change < low_(i)) change = std::abs(change);
      if (at(i) + change > high_(i)) change = -std::abs(change);
    }
    put_change(environment_, change_, action);
    if (action.size() > 3) action[3] = random_.uniform() < kMarks ? 1.0 : 0.0;
  }

 private:
  const Environment& environment_;
  Random random_;
  Vec3 low_, high_;  // m, of the position from the start
  Vec3 change_ = Vec3::Zero();
};

/// Moves along the approach: in air with constant speed, in contact by the error of the force. A needle goes
/// on slowly until it is in its target.
class ForceController final : public Policy {
 public:
  explicit ForceController(const Environment& environment) : environment_(environment) {}

  void act(const StepResult& last, std::span<double> action) override {
    constexpr double kGain = 2.0;       // of the largest change, per newton
    constexpr double kApproach = 0.5;   // of the largest change
    constexpr double kInsertion = 0.1;  // of the largest change
    const double target = environment_.observation()[8];
    const double share =
        environment_.settings().task == Task::kInsert ? (last.reward > 0.0 ? 0.0 : kInsertion)
        : last.tissue_force > 0.0 ? std::clamp(kGain * (target - last.tissue_force), -1.0, 1.0)
                                  : kApproach;
    put_change(environment_, share * environment_.step_limit() * environment_.approach(), action);
  }

 private:
  const Environment& environment_;
};

/// Presses at the points of the search path's grid, then marks them in the order of their forces.
class Raster final : public Policy {
 public:
  explicit Raster(const Environment& environment) : environment_(environment) {
    scene::Scene search = environment.scene();
    search.task = scene::Task::kPalpate;
    const std::vector<scene::PathRow> rows = scene::default_path(search, 0).rows();
    const auto direction = [&rows](std::size_t i) -> Vec3 {
      return (rows[i + 1].position - rows[i].position).normalized();
    };
    for (std::size_t i = 1; i < rows.size(); ++i) {
      constexpr double kStraight = 0.99;  // cosine
      const bool corner = i + 1 == rows.size() || direction(i - 1).dot(direction(i)) < kStraight;
      if (corner) corners_.push_back(rows[i].position - environment.start());
    }
  }

  void act(const StepResult& last, std::span<double> action) override {
    std::fill(action.begin(), action.end(), 0.0);
    const Vec3 at = moved(environment_);
    if (next_ < corners_.size() && (corners_[next_] - at).norm() < kArrived) {
      if (is_bottom() && !std::exchange(rested_, true)) return;  // a moving tool also feels the damping
      if (rested_) presses_.emplace_back(last.tissue_force, at);
      rested_ = false;
      if (++next_ == corners_.size()) {
        std::stable_sort(presses_.begin(), presses_.end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
      }
    }
    if (next_ < corners_.size()) return put_change(environment_, corners_[next_] - at, action);
    if (marked_ == presses_.size()) return;  // all were wrong
    Vec3 to = presses_[marked_].second - at;
    to.z() = 0.0;
    put_change(environment_, to, action);
    if (to.norm() > kArrived) return;
    action[3] = 1.0;
    ++marked_;
  }

 private:
  static constexpr double kArrived = 1e-6;  // m

  /// Whether the next corner is the lowest point of a press.
  [[nodiscard]] bool is_bottom() const {
    return next_ > 0 && next_ + 1 < corners_.size() &&
           corners_[next_].z() < std::min(corners_[next_ - 1].z(), corners_[next_ + 1].z());
  }

  const Environment& environment_;
  std::vector<Vec3> corners_;  // m, from the start
  std::size_t next_ = 0;
  bool rested_ = false;                           // for a step, at the lowest point
  std::vector<std::pair<double, Vec3>> presses_;  // force and position of the lowest points
  std::size_t marked_ = 0;
};

}  // namespace

const char* to_string(PolicyKind kind) noexcept {
  return kind == PolicyKind::kRandom ? "random" : "scripted";
}

PolicyKind parse_policy(const std::string& text) {
  for (const PolicyKind kind : {PolicyKind::kRandom, PolicyKind::kScripted}) {
    if (text == to_string(kind)) return kind;
  }
  throw InputError("policy: " + one_line(text) + " is not random or scripted");
}

std::unique_ptr<Policy> make_policy(PolicyKind kind, const Environment& environment, std::uint64_t seed) {
  if (kind == PolicyKind::kRandom) return std::make_unique<RandomWalk>(environment, seed);
  if (environment.settings().task == Task::kSearch) return std::make_unique<Raster>(environment);
  return std::make_unique<ForceController>(environment);
}

}  // namespace palpate::learning
