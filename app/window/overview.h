#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "app/recorded_view.h"
#include "app/window/plot.h"

namespace palpate::app {

/// Summary of one hand's whole run.
struct HandOverview {
  /// Contact from tick `first` to `last`, both included.
  struct Contact {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  std::vector<PlotColumn> depth;  // [mm] over time [s], Overview::kColumns of equal width
  double deepest_mm = 0.0;
  std::vector<Contact> contacts;
  std::uint64_t deepest = 0;          // tick of the largest depth
  std::vector<std::uint64_t> faults;  // ticks at which a fault was latched
};

/// Summary of a whole recording, for the timeline and its navigation.
struct Overview {
  static constexpr std::size_t kColumns = 1024;

  std::vector<HandOverview> hands;
  std::vector<std::uint64_t> changes;  // ticks at which tissue or noise parameters change
  double column_width = 0.0;           // s
};

/// [setup] Reads every row once.
[[nodiscard]] Overview overview_of(RecordedView& seen);

/// [any] First fault after a tick; if none follows, the first of the run; nothing without any fault.
[[nodiscard]] std::optional<std::uint64_t> next_fault(const HandOverview& hand, std::uint64_t after);

/// [setup] Tissue and noise parameters in force at a tick.
struct ActiveParameters {
  model::TissueParameters tissue;
  haptics::LiveNoise noise;
};
[[nodiscard]] ActiveParameters active_parameters(const record::Recording& recording, std::uint64_t tick);

}  // namespace palpate::app
