// Devices of the portable build: a program brings its own, or follows a path (palpate_scripted_sample).
#include "run/devices/devices.h"

#include "palpate/error.h"

namespace palpate::devices {

std::unique_ptr<haptics::Device> open_device(const scene::Scene& scene, std::size_t hand,
                                             const OnWait& /*on_wait*/) {
  throw InputError("device " + scene.devices.at(hand).kind +
                   ": this build of palpate cannot open it, must be scripted or host");
}

}  // namespace palpate::devices
