#include "core/haptics/warm_up.h"

#include <algorithm>
#include <vector>

namespace palpate::haptics {
namespace {

constexpr double kSpeed = 5.0;       // m/s, of the tools, a quarter of a jump's
constexpr double kDepth = 2e-3;      // m, of the press
constexpr int kMostTicks = 100;      // they reach organs up to half a metre away at 1 kHz
constexpr int kTicksInContact = 10;  // several, as the first ticks of a contact run only parts of the code

/// Moves each tool from its pose to the nearest place of the organ and into it.
void press_organ(const SimulationWorld& world, SimulationState& state) noexcept {
  const double step = kSpeed / world.rate_Hz;
  int in_contact = 0;
  for (int k = 0; k < kMostTicks && in_contact < kTicksInContact; ++k) {
    contact::advance(world.contact, state.organ_W, state.inputs, state.contact, state.results);
    bool all_touch = true;
    for (std::size_t hand = 0; hand < world.hands(); ++hand) {
      const contact::ToolResult& result = state.results[hand];
      if (result.phase != contact::Phase::kApproach) continue;
      all_touch = false;
      const double way = std::min(step, std::max(0.0, result.distance) + kDepth);
      state.inputs[hand].pose_W.position -= way * result.away_W;
    }
    if (all_touch) ++in_contact;
  }
}

}  // namespace

void warm_up(const SimulationWorld& world, SimulationState& state) {
  constexpr int kFirstTicks = 4;
  const SimulationState before = state;
  const std::vector<DeviceState> samples(world.hands());
  std::vector<ForceCommand> commands(world.hands());
  std::vector<TickRow> rows(world.hands());
  tick(world, state, 0, samples, commands, rows);
  press_organ(world, state);
  for (int k = 0; k < kFirstTicks; ++k) {  // last, as the run begins with a first tick
    state = before;
    tick(world, state, 0, samples, commands, rows);
  }
  state = before;
}

}  // namespace palpate::haptics
