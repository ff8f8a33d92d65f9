#include "palpate/haptics/snapshot.h"

#include "palpate/haptics/simulation.h"

namespace palpate::haptics {

void make_snapshot(const SimulationState& state, std::span<const ForceCommand> commands, std::uint64_t tick,
                   std::int64_t taken_ns, Snapshot& snapshot) noexcept {
  const std::size_t hands = std::min(state.inputs.size(), Snapshot::kMaxHands);
  snapshot.tick = tick;
  snapshot.taken_ns = taken_ns;
  snapshot.organ_W = state.organ_W;
  snapshot.hands = static_cast<std::uint32_t>(hands);
  std::copy_n(state.inputs.begin(), hands, snapshot.tools.begin());
  std::copy_n(state.results.begin(), hands, snapshot.results.begin());
  std::copy_n(commands.begin(), hands, snapshot.commands.begin());
  for (std::size_t hand = 0; hand < hands; ++hand) snapshot.faults[hand] = state.gates[hand].fault;
  snapshot.change = state.change;
  snapshot.reach = state.reach;
}

}  // namespace palpate::haptics
