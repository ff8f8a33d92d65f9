#include "core/haptics/simulation.h"
#include "palpate/tick_observer.h"

namespace palpate::haptics {

void make_snapshot(const TickState& now, Snapshot& snapshot) noexcept {
  const SimulationState& state = now.state;
  const std::size_t hands = std::min(state.inputs.size(), kMaxHands);
  snapshot.tick = now.tick;
  snapshot.taken_ns = now.taken_ns;
  snapshot.organ_W = state.organ_W;
  snapshot.hands = static_cast<std::uint32_t>(hands);
  std::copy_n(state.inputs.begin(), hands, snapshot.tools.begin());
  std::copy_n(state.results.begin(), hands, snapshot.results.begin());
  std::copy_n(now.commands.begin(), hands, snapshot.commands.begin());
  for (std::size_t hand = 0; hand < hands; ++hand) snapshot.faults[hand] = state.gates[hand].fault;
  snapshot.change = state.change;
  snapshot.reach = state.reach;
}

}  // namespace palpate::haptics
