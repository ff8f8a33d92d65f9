#include "fit/identify/needle_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/infinity.h"
#include "core/contact/needle.h"

namespace palpate::identify {
namespace {

constexpr double kNeverYields = 1e9;  // N
constexpr double kSlipStep = 25e-3;   // s: a tick's slip meets the friction of the length before it
constexpr double kSnapStep = 3e-3;    // s, where tissue snaps off the needle: it takes 20 ms and more
constexpr double kSnapLength = 1e-3;  // m, of a layer's shaft on which its constant friction falls
constexpr double kYieldStep = 10e-6;  // s, of the tick after which a membrane's force falls

/// A needle on one line, tick by tick. It presses until the surface yields, as a contact of the simulation.
class NeedleOnLine final {
 public:
  NeedleOnLine(const model::TissueParameters& tissue, bool guided)
      : laws_(tissue, 1e-3), layers_(tissue.layers) {
    needle_.axis = -Vec3::UnitZ();
    needle_.length = 1.0;  // longer than any record
    for (model::TissueLayer& layer : layers_) {
      if (!guided) continue;
      layer.puncture_force = kNeverYields;
      layer.thickness = kInfinity;
    }
  }

  /// One tick. @param depth of the tip [m] at its end @param period [s]
  void tick(double time, double depth, double period) {
    laws_.relaxation.set_step(period);
    if (!inside_.is_inside() && force_ > 0.0 && force_ >= layers_.front().puncture_force) {
      inside_.puncture_flat(layers_, depth_, force_, memory_);
      add_puncture(force_, 0.0);
    }
    if (inside_.is_inside()) {
      insert(depth, period);
    } else {
      const double elastic = laws_.press.force_at(depth).force;
      force_ =
          std::max(0.0, laws_.relaxation.count() > 0 ? laws_.relaxation.next(memory_, elastic) : elastic);
    }
    depth_ = depth;
    time_ = time;
  }

  /// The next membrane yields in the next tick.
  void yield() {
    const std::size_t next = yielded_++;
    if (next >= layers_.size()) return;
    layers_[next].puncture_force = inside_.is_inside() ? inside_.state().tip_force : std::max(0.0, force_);
  }

  /// The tip is at the end of its layer.
  void reach() {
    if (yielded_ == 0 || yielded_ >= layers_.size()) return;
    const double before = punctures_.empty() ? 0.0 : punctures_.back().length;
    layers_[yielded_ - 1].thickness = inside_.state().length - before;
  }

  /// [s], where the needle slips or may begin to.
  [[nodiscard]] double longest_tick() const noexcept {
    if (!inside_.is_inside()) return kInfinity;
    double start = 0.0;
    for (const model::TissueLayer& layer : layers_) {
      const double inside = inside_.state().length - start;
      if (inside_.state().slip < 0 && inside >= 0.0 && inside < kSnapLength) return kSnapStep;
      start += layer.thickness;
    }
    return kSlipStep;
  }
  [[nodiscard]] double force() const noexcept { return force_; }
  [[nodiscard]] const std::vector<Puncture>& punctures() const noexcept { return punctures_; }

 private:
  void insert(double depth, double period) {
    const double tip = inside_.state().tip_force;
    const double length = inside_.state().length;
    inside_.clear_state();
    inside_.advance(nullptr, {laws_, {}, map_, 0.0}, layers_, needle_, {Quat::Identity(), Vec3(0, 0, -depth)},
                    period);
    if (inside_.state().punctured) add_puncture(tip, length);
    force_ = inside_.is_inside() ? inside_.force().z() : 0.0;
    if (!inside_.is_inside()) memory_ = {};
  }

  void add_puncture(double tip, double length) {
    if (punctures_.size() < layers_.size()) punctures_.push_back({time_, depth_, force_, tip, length});
  }

  contact::TissueLaws laws_;
  std::vector<model::TissueLayer> layers_;
  contact::StiffnessMap map_;
  geometry::Needle needle_;
  contact::NeedleInsertion inside_;
  model::RelaxationState memory_;
  std::size_t yielded_ = 0;
  double time_ = 0.0;
  double depth_ = 0.0;
  double force_ = 0.0;
  std::vector<Puncture> punctures_;
};

}  // namespace

NeedleRun run_needle(const NeedleRecord& record, const model::TissueParameters& tissue, double contact,
                     std::span<const double> times, double longest_step) {
  NeedleOnLine needle(tissue, !times.empty());
  NeedleRun run;
  std::size_t next = 0;  // of `times`
  double time = record.time.front();
  bool yielding = false;
  needle.tick(time, record.depth.front() - contact, longest_step);
  run.force.push_back(needle.force());
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double from = record.time[i - 1];
    const double speed = (record.depth[i] - record.depth[i - 1]) / (record.time[i] - from);
    while (time < record.time[i]) {
      const double event = next < times.size() ? times[next] : kInfinity;
      double end = std::min(record.time[i], event > time ? event : kInfinity);
      const double longest = speed == 0.0 ? longest_step : std::min(needle.longest_tick(), longest_step);
      const double ticks = std::ceil((end - time) / longest - 1e-9);
      if (ticks > 1.0) end = time + (end - time) / ticks;
      if (yielding) end = std::min(end, time + kYieldStep);
      yielding = false;
      needle.tick(end, record.depth[i - 1] + speed * (end - from) - contact, end - time);
      time = end;
      if (time >= event) {
        yielding = next % 2 == 0;
        yielding ? needle.yield() : needle.reach();
        ++next;
      }
    }
    run.force.push_back(needle.force());
  }
  run.punctures = needle.punctures();
  return run;
}

}  // namespace palpate::identify
