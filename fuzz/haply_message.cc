// Messages of Haply's service: the inventory, and the states of the listed devices.
#include <cmath>

#include "run/devices/haply_messages.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string text(data, data + size);
  devices::HaplyInventory inventory;
  fuzz::read_or_refuse("message", [&] { inventory = devices::read_haply_inventory(text); });
  for (std::size_t place = 0; place < inventory.arms.size(); ++place) {
    const std::string& arm = inventory.arms[place];
    const std::string grip = place < inventory.grips.size() ? inventory.grips[place] : "";
    fuzz::read_or_refuse("message", [&] {
      const haptics::DeviceState state = devices::read_haply_state(text, arm, grip).state;
      fuzz::require(state.position_D.allFinite() && state.velocity_D.allFinite(), "a state is finite", text);
      fuzz::require(std::abs(state.orientation_D.norm() - 1.0) < 1e-9, "an orientation is a rotation", text);
    });
    const std::string command = devices::haply_force_command(arm, Vec3::Zero(), inventory.force_field);
    fuzz::require(command.find_first_of("\r\n") == std::string::npos, "a command is one line", command);
  }
  return 0;
}
