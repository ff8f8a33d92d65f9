#include "palpate/device.h"

namespace palpate::haptics {

const char* name_of(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNotFinite:
      return "not-finite";
    case Fault::kDevice:
      return "device";
    case Fault::kStale:
      return "stale-sample";
    case Fault::kStalled:
      return "stalled-loop";
    case Fault::kForceOff:
      return "force-off";
    case Fault::kUnstable:
      return "unstable";
    case Fault::kNone:
      break;
  }
  return "none";
}

const char* describe(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNotFinite:
      return "a device sample or a force was not finite";
    case Fault::kDevice:
      return "the device could not be read, or refused a command";
    case Fault::kStale:
      return "the device gave no new sample for 5 ms";
    case Fault::kStalled:
      return "the loop stood still for 20 ms";
    case Fault::kForceOff:
      return "the device switched its force off by itself";
    case Fault::kUnstable:
      return "the force gave the hand more energy than the passivity controller could take back: lower the "
             "tissue's stiffness, contact damping or workspace_scale, or raise rate_Hz or max_slew_N_per_ms";
    case Fault::kNone:
      break;
  }
  return "no fault";
}

}  // namespace palpate::haptics
