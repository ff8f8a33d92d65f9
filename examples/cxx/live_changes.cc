// Tissue and noise are changed from another thread while the loop runs, in real time: what a slider does.
#include "palpate/haptics/live_changes.h"

#include <chrono>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "palpate/base/error.h"
#include "palpate/devices/scripted.h"
#include "palpate/haptics/loop.h"
#include "palpate/scene/load.h"
#include "palpate/scene/make_world.h"
#include "palpate/scene/tool_path.h"

namespace {

using namespace std::chrono_literals;

/// A hand that goes 8 mm into the organ within half a second and stays there.
palpate::scene::ToolPath press_and_hold(const palpate::scene::Setup& setup) {
  palpate::scene::PathRow above = palpate::scene::default_path(setup, 0).at(0.0);  // 10 mm clear of the organ
  palpate::scene::PathRow inside = above;
  inside.position.z() -= 18e-3;
  inside.time = 0.5;
  return palpate::scene::ToolPath({above, inside});
}

/// Remembers what was felt at the first tick of every change.
class Watch final : public palpate::haptics::TickObserver {
 public:
  Watch() { lines_.reserve(16); }
  void on_update(const palpate::haptics::LiveChange& change) noexcept override { number_ = change.number; }
  void on_row(const palpate::haptics::TickRow& row) noexcept override {
    if (number_ != seen_ && lines_.size() < lines_.capacity()) lines_.push_back({number_, row.time, force_});
    seen_ = number_;
    force_ = row.tissue_force;
  }
  void tell() const {
    for (const Line& line : lines_) {
      std::cout << "change " << line.number << " at " << line.time << " s; before it " << line.force
                << " N\n";
    }
    std::cout << "at the end " << force_ << " N\n";
  }
  std::size_t changes() const { return lines_.size(); }

 private:
  struct Line {
    std::uint64_t number;
    double time;   // s
    double force;  // N, of the tick before
  };
  std::vector<Line> lines_;
  std::uint64_t number_ = 0;
  std::uint64_t seen_ = 0;
  double force_ = 0.0;
};

}  // namespace

int main() {
  const palpate::scene::Setup setup = palpate::scene::load({});
  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  palpate::devices::ScriptedDevice device(press_and_hold(setup));
  palpate::haptics::Device* const hand = &device;
  const auto changes = palpate::scene::live_changes(setup, world);

  Watch watch;
  palpate::haptics::LoopOptions options;
  options.ticks = 2000;                                 // two seconds of wall time
  palpate::haptics::RunControl control(changes.get());  // stops and pauses a run, too
  options.control = &control;
  std::thread loop([&] { (void)palpate::haptics::run_loop(world, state, {&hand, 1}, {&watch}, options); });

  // Everything is checked and worked out here; the loop only picks up the result at one of its next ticks.
  std::this_thread::sleep_for(800ms);
  palpate::model::TissueParameters stiffer = setup.tissue;
  stiffer.k1 *= 2.0;
  (void)changes->offer(stiffer);
  std::this_thread::sleep_for(400ms);
  (void)changes->offer(palpate::haptics::LiveNoise{.enabled = false});
  try {
    stiffer.k1 = -1.0;
    (void)changes->offer(stiffer);
  } catch (const palpate::ParameterError& error) {
    std::cout << "refused: " << error.what() << '\n';  // nothing has changed
  }
  loop.join();
  watch.tell();
  return watch.changes() == 2 ? 0 : 1;
}
