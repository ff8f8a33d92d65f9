// One haptic tick of the built-in press by the C++ library: sample in, row out.
#include <iostream>
#include <vector>

#include "palpate/devices/devices.h"
#include "palpate/haptics/simulation.h"
#include "palpate/scene/setup.h"
#include "palpate/scene/make_world.h"

int main() {
  const palpate::scene::Setup setup = palpate::scene::load({});
  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  const auto device = palpate::devices::open_device(setup, 0);
  std::vector<palpate::haptics::ForceCommand> commands(world.hands());
  std::vector<palpate::haptics::TickRow> rows(world.hands());
  const std::vector<palpate::haptics::DeviceState> samples = {device->read(0, 0.0)};
  palpate::haptics::tick(world, state, 0, samples, commands, rows);
  std::cout << "the tool is " << 1e3 * rows[0].distance << " mm from the organ\n";
  return 0;
}
