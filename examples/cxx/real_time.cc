// One second of the loop in real time: what it asked of the system, what it got, and how punctual it was.
#include <iostream>
#include <string>

#include "palpate/devices/devices.h"
#include "palpate/haptics/loop.h"
#include "palpate/haptics/machine_checks.h"
#include "palpate/scene/load.h"
#include "palpate/scene/make_world.h"

namespace {

void show(const char* what, const palpate::haptics::Histogram& times) {
  std::cout << what << ": median " << 1e-3 * static_cast<double>(times.percentile(0.5))
            << " us, 99.9 % within " << 1e-3 * static_cast<double>(times.percentile(0.999)) << " us\n";
}

}  // namespace

int main() {
  // What `palpate doctor` tells.
  for (const palpate::haptics::MachineCheck& check : palpate::haptics::check_machine()) {
    std::cout << check.name << ": " << check.found << '\n';
    if (!check.advice.empty()) std::cout << "  " << check.advice << '\n';
  }

  const palpate::scene::Setup setup = palpate::scene::load({});
  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  const auto device = palpate::devices::open_device(setup, 0);
  palpate::haptics::Device* const hand = device.get();

  palpate::haptics::LoopOptions options;
  options.ticks = 1000;
  const auto report = palpate::haptics::run_loop(world, state, {&hand, 1}, {}, options);
  show("computing a tick", report.tick_time);
  show("a tick begins late by", report.lateness);
  std::cout << report.ticks << " ticks, " << report.missed_deadlines << " missed deadlines\n";
  for (const std::string& remark : report.remarks) std::cout << "note: " << remark << '\n';
  return report.ticks == options.ticks ? 0 : 1;
}
