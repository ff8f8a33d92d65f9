#include "palpate/scene/emulated_hand.h"

namespace palpate::scene {
namespace {

constexpr EmulatedFaultName kNames[] = {
    {"freeze", EmulatedFaultKind::kFreeze},      {"drop-out", EmulatedFaultKind::kDropOut},
    {"nan", EmulatedFaultKind::kNotANumber},     {"spike", EmulatedFaultKind::kSpike},
    {"late", EmulatedFaultKind::kLate},          {"wrong-units", EmulatedFaultKind::kWrongUnits},
    {"force-off", EmulatedFaultKind::kForceOff}, {"refuse", EmulatedFaultKind::kRefuse},
};

}  // namespace

std::span<const EmulatedFaultName> emulated_fault_names() noexcept { return kNames; }

std::string_view name_of(EmulatedFaultKind kind) noexcept {
  for (const EmulatedFaultName& known : kNames) {
    if (known.kind == kind) return known.name;
  }
  return "";
}

std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept {
  for (const EmulatedFaultName& known : kNames) {
    if (known.name == name) return known.kind;
  }
  return std::nullopt;
}

}  // namespace palpate::scene
