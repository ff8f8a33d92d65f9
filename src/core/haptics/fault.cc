#include <array>

#include "palpate/device.h"

namespace palpate::haptics {
namespace {

struct FaultText {
  const char* name;
  const char* description;
};

/// By number of the fault.
constexpr std::array<FaultText, static_cast<std::size_t>(kLastFault) + 1> kFaultTexts{
    {{"none", "no fault"},
     {"not-finite", "a device sample or a force was not finite"},
     {"device", "the device could not be read, or refused a command"},
     {"stale-sample", "the device gave no new sample for 5 ms"},
     {"stalled-loop", "the loop stood still for 20 ms"},
     {"force-off", "the device switched its force off by itself"},
     {"unstable",
      "the force gave the hand more energy than the passivity controller could take back: lower the tissue's "
      "stiffness, contact damping or workspace_scale, or raise rate_Hz or max_slew_N_per_ms"}}};
static_assert(kFaultTexts.back().description != nullptr, "each fault has a text");

const FaultText& text_of(Fault fault) noexcept {
  return kFaultTexts[fault > kLastFault ? 0 : static_cast<std::size_t>(fault)];
}

}  // namespace

const char* name_of(Fault fault) noexcept { return text_of(fault).name; }

const char* describe(Fault fault) noexcept { return text_of(fault).description; }

}  // namespace palpate::haptics
