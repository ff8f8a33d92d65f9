#include "palpate/scene.h"

namespace palpate::scene {
namespace {

constexpr EmulatedFaultName kFaultNames[] = {
    {"freeze", EmulatedFaultKind::kFreeze},      {"drop-out", EmulatedFaultKind::kDropOut},
    {"nan", EmulatedFaultKind::kNotANumber},     {"spike", EmulatedFaultKind::kSpike},
    {"late", EmulatedFaultKind::kLate},          {"wrong-units", EmulatedFaultKind::kWrongUnits},
    {"force-off", EmulatedFaultKind::kForceOff}, {"refuse", EmulatedFaultKind::kRefuse},
};

}  // namespace

std::span<const EmulatedFaultName> emulated_fault_names() noexcept { return kFaultNames; }

std::string_view name_of(EmulatedFaultKind kind) noexcept {
  for (const EmulatedFaultName& known : kFaultNames) {
    if (known.kind == kind) return known.name;
  }
  return "";
}

std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept {
  for (const EmulatedFaultName& known : kFaultNames) {
    if (known.name == name) return known.kind;
  }
  return std::nullopt;
}

}  // namespace palpate::scene
