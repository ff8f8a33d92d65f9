#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "app/recorded_view.h"
#include "app/window/plot.h"

namespace palpate::app {

/// One hand's whole run at a glance.
struct HandOverview {
  /// From tick `first` to `last`, both in it.
  struct Contact {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  std::vector<PlotColumn> depth;  // [mm] over time [s], Overview::kColumns of equal width
  double deepest_mm = 0.0;
  std::vector<Contact> contacts;
  std::uint64_t deepest = 0;          // tick
  std::vector<std::uint64_t> faults;  // ticks at which one was latched
};

/// A whole recording at a glance, for its timeline and for jumps.
struct Overview {
  static constexpr std::size_t kColumns = 1024;

  std::vector<HandOverview> hands;
  std::vector<std::uint64_t> changes;  // ticks from which tissue or noise were others
  double column_width = 0.0;           // s
};

/// [setup] Looks once at every row.
[[nodiscard]] Overview overview_of(RecordedView& seen);

/// [any] The fault after a tick, or the first when there is none after it; nothing: there is none.
[[nodiscard]] std::optional<std::uint64_t> next_fault(const HandOverview& hand, std::uint64_t after);

/// [setup] Tissue in force at a tick, and noise.
struct ActiveParameters {
  model::TissueParameters tissue;
  haptics::LiveNoise noise;
};
[[nodiscard]] ActiveParameters active_parameters(const record::Recording& recording, std::uint64_t tick);

}  // namespace palpate::app
