#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// Keeps the last ticks of a run without a recording, and stops shortly after the first fault, so that its
/// cause can be examined.
class FlightRecorder final : public haptics::TickObserver {
 public:
  static constexpr double kKept = 2.0;    // s before the fault
  static constexpr double kAfter = 0.25;  // s from the fault on
  static constexpr std::size_t kChangesKept = 64;

  /// [setup] @param scene must outlive this @param study that the run belongs to
  explicit FlightRecorder(const scene::Scene& scene, StudyMark study = {});

  void on_start(std::int64_t started_unix_ns) noexcept override;
  void on_update(const haptics::ParameterUpdate& change) noexcept override;
  void on_row(const haptics::TickRow& row) noexcept override;

  /// [setup] After the run: whether a fault occurred.
  [[nodiscard]] bool fault_met() const noexcept { return fault_met_; }
  /// [setup] After the run: the kept rows, oldest first, only complete ticks.
  [[nodiscard]] std::vector<haptics::TickRow> rows() const;
  /// [setup] After the run: the last kChangesKept updates of tissue and noise, oldest first.
  [[nodiscard]] std::vector<haptics::ParameterUpdate> changes() const;
  /// [setup] After the run: writes them as a recording whose first tick is not 0. It can be viewed and
  /// exported, but not replayed. @throws InputError naming the file.
  void write(const std::filesystem::path& file, const haptics::LoopReport& report) const;

 private:
  const scene::Scene& scene_;
  StudyMark study_;
  std::size_t hands_;
  std::size_t rows_after_fault_;
  std::vector<haptics::TickRow> ring_;
  std::uint64_t seen_ = 0;  // rows pushed to the ring so far
  std::array<haptics::ParameterUpdate, kChangesKept> changes_{};
  std::uint64_t changes_seen_ = 0;
  std::int64_t started_unix_ns_ = 0;
  bool fault_met_ = false;
};

/// [setup] After a run with a fault: writes the kept rows into the user's state folder, and removes the
/// oldest such files beyond 256 MiB. @return the file; empty when no such folder exists @throws InputError
/// when it cannot be written.
std::filesystem::path write_flight_recording(const FlightRecorder& flight, const haptics::LoopReport& report);

}  // namespace palpate::record
