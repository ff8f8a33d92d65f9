#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "palpate/haptics/loop.h"
#include "palpate/net/igtl_clients.h"
#include "palpate/scene/setup.h"

namespace palpate::app {

/// A stretch of ticks that one hand spent in one phase.
struct PhaseSpan {
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double from = 0.0;        // s
  double to = 0.0;          // s, of the first tick after it
};

/// What a run was like, from its rows.
struct Highlights {
  static constexpr std::size_t kMaxSpans = 256;

  double peak_force = 0.0;   // N, at the device
  double peak_tissue = 0.0;  // N, before the gate
  double peak_depth = 0.0;   // m
  std::uint64_t deepest_tick = 0;
  std::uint32_t deepest_hand = 0;
  std::uint64_t contact_ticks = 0;  // ticks with a hand pressing or pulling
  std::uint64_t limited_ticks = 0;  // ticks in which the gate shortened a force or torque
  std::uint32_t status = 0;         // all bits seen
  std::uint64_t changes = 0;        // of tissue or noise while the run went on
  std::vector<PhaseSpan> phases;    // in order of their begin
  std::uint64_t phases_left_out = 0;
};

/// Looks at every row on its way to the recorder.
class RowWatch final : public haptics::TickSink {
 public:
  /// [setup] @param next where the rows go on to; may be null
  RowWatch(haptics::TickSink* next, const scene::Setup& setup);

  void begin(std::int64_t started_unix_ns) noexcept override;
  void put_change(const haptics::LiveChange& change) noexcept override;
  void put(const haptics::TickRow& row) noexcept override;

  /// [setup] After the run.
  [[nodiscard]] const Highlights& highlights() const noexcept { return highlights_; }

 private:
  void follow_phase(const haptics::TickRow& row) noexcept;

  haptics::TickSink* next_;
  double period_;
  std::uint64_t last_contact_tick_;
  std::uint64_t last_limited_tick_;
  std::vector<std::int64_t> open_span_;  // of each hand, index into phases; -1: none, or left out
  std::vector<std::int64_t> last_phase_;
  Highlights highlights_;
};

/// Where a run's outputs are; empty: not asked for.
struct OutputFiles {
  std::filesystem::path recording;
  std::filesystem::path report;
  std::filesystem::path screenshot;
};

/// One run with all that is told about it.
struct RunAccount {
  const scene::Setup* setup = nullptr;
  bool offline = false;
  haptics::LoopReport loop;
  Highlights highlights;
  std::optional<net::IgtlTally> igtl;     // what --igtl did; none: it was not asked for
  std::filesystem::path fault_recording;  // the last ticks before a fault of an unrecorded run; empty: none
};

/// [setup] What is wrong or worth knowing, in words: the scene's repairs and remarks, the loop's, what the
/// status bits say.
[[nodiscard]] std::vector<std::string> remarks(const RunAccount& run);

/// [setup] The document that `palpate run --json` prints (docs/file-formats.md).
[[nodiscard]] nlohmann::ordered_json summary_json(const RunAccount& run, const OutputFiles& files);

/// [setup] The same for people.
void print_summary(std::ostream& out, const RunAccount& run, const OutputFiles& files);

}  // namespace palpate::app
