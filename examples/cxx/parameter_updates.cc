// Changes tissue and noise from another thread while the loop runs in real time, as a slider would.
#include "palpate/parameter_updates.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <thread>
#include <utility>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"
#include "palpate/session.h"
#include "palpate/tool_path.h"

namespace {

using namespace std::chrono_literals;

/// A hand that moves 8 mm into the organ within half a second and stays there.
palpate::scene::ToolPath press_and_hold(const palpate::scene::Scene& scene) {
  palpate::scene::PathRow above = palpate::scene::default_path(scene, 0).at(0.0);  // 10 mm above the organ
  palpate::scene::PathRow inside = above;
  inside.position.z() -= 18e-3;
  inside.time = 0.5;
  return palpate::scene::ToolPath({above, inside});
}

/// Records the force at the first tick of every parameter update.
class Watch final : public palpate::haptics::TickObserver {
 public:
  Watch() { lines_.reserve(16); }
  void on_update(const palpate::haptics::ParameterUpdate& change) noexcept override {
    number_ = change.number;
  }
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
    double force;  // N, at the previous tick
  };
  std::vector<Line> lines_;
  std::uint64_t number_ = 0;
  std::uint64_t seen_ = 0;
  double force_ = 0.0;
};

}  // namespace

int main() {
  palpate::scene::Scene scene = palpate::scene::load({});
  palpate::model::TissueParameters stiffer = scene.tissue;
  palpate::session::SessionOptions options{.duration_s = 2.0};
  options.devices.push_back(std::make_unique<palpate::devices::ScriptedDevice>(press_and_hold(scene)));
  palpate::session::Session session(std::move(scene), std::move(options));

  Watch watch;
  const auto run = session.run_in_background({}, {&watch});

  // offer() checks the parameters and derives everything from them. The loop takes the result at a later
  // tick.
  std::this_thread::sleep_for(800ms);
  stiffer.k1 *= 2.0;
  (void)session.updates().offer(stiffer);
  std::this_thread::sleep_for(400ms);
  (void)session.updates().offer(palpate::haptics::LiveNoise{.enabled = false});
  try {
    stiffer.k1 = -1.0;
    (void)session.updates().offer(stiffer);
  } catch (const palpate::ParameterError& error) {
    std::cout << "refused: " << error.what() << '\n';  // nothing has changed
  }
  run->wait();
  watch.tell();
  return watch.changes() == 2 ? 0 : 1;
}
