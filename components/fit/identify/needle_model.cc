#include "fit/identify/needle_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/infinity.h"
#include "core/contact/needle.h"

namespace palpate::identify {
namespace {

constexpr double kNeverYields = 1e9;  // N

/// A needle on one line, tick by tick. It presses until the surface yields, as a contact of the simulation.
class NeedleOnLine final {
 public:
  NeedleOnLine(const model::TissueParameters& tissue, bool guided)
      : laws_(tissue, 1e-3), layers_(tissue.layers) {
    needle_.axis = -Vec3::UnitZ();
    needle_.length = 1.0;  // longer than any record
    for (model::TissueLayer& layer : layers_) {
      if (guided) layer.puncture_force = kNeverYields;
    }
  }

  /// One tick. @param depth of the tip [m] at its end @param period [s]
  void tick(double time, double depth, double period) {
    laws_.relaxation.set_step(period);
    if (!inside_.is_inside() && force_ > 0.0 && force_ >= layers_.front().puncture_force) {
      inside_.puncture_flat(layers_, depth_, force_, memory_);
      add_puncture(force_);
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

  [[nodiscard]] double force() const noexcept { return force_; }
  [[nodiscard]] const std::vector<Puncture>& punctures() const noexcept { return punctures_; }

 private:
  void insert(double depth, double period) {
    const double tip = inside_.state().tip_force;
    inside_.clear_state();
    inside_.advance(nullptr, {laws_, {}, map_, 0.0}, layers_, needle_, {Quat::Identity(), Vec3(0, 0, -depth)},
                    period);
    if (inside_.state().punctured) add_puncture(tip);
    force_ = inside_.is_inside() ? inside_.force().z() : 0.0;
    if (!inside_.is_inside()) memory_ = {};
  }

  void add_puncture(double tip) {
    if (punctures_.size() < layers_.size()) punctures_.push_back({time_, depth_, force_, tip});
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
  needle.tick(time, record.depth.front() - contact, longest_step);
  run.force.push_back(needle.force());
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double from = record.time[i - 1];
    const double speed = (record.depth[i] - record.depth[i - 1]) / (record.time[i] - from);
    while (time < record.time[i]) {
      const double yields = next < times.size() ? times[next] : kInfinity;
      double end = std::min(record.time[i], yields > time ? yields : kInfinity);
      const double ticks = std::ceil((end - time) / longest_step - 1e-9);
      if (ticks > 1.0) end = time + (end - time) / ticks;
      needle.tick(end, record.depth[i - 1] + speed * (end - from) - contact, end - time);
      time = end;
      if (time >= yields) {
        needle.yield();
        ++next;
      }
    }
    run.force.push_back(needle.force());
  }
  run.punctures = needle.punctures();
  return run;
}

}  // namespace palpate::identify
