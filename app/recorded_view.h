#pragma once
#include <cstdint>
#include <filesystem>

#include "io/record/recording_frames.h"
#include "palpate/offscreen.h"
#include "palpate/recording.h"

#include "app/progress.h"

namespace palpate::app {

/// A recording that is opened for display. Pictures, films and the viewer's window show the same ticks from
/// the same camera. For one thread, unless noted.
class RecordedView final {
 public:
  /// [setup] Reads the file and prepares its organ. @param no_cache ignores the cache of prepared organs
  /// @param break_blind opens the recording of a study that is still blind, too
  /// @throws InputError naming the file when it cannot be read or replayed, or contains no tick.
  RecordedView(std::filesystem::path file, bool no_cache, const record::Progress& progress = {},
               bool break_blind = false);
  RecordedView(const RecordedView&) = delete;
  RecordedView& operator=(const RecordedView&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  [[nodiscard]] const record::Recording& recording() const noexcept { return recording_; }
  [[nodiscard]] record::RecordingFrames& frames() noexcept { return frames_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return frames_.ticks(); }
  [[nodiscard]] std::uint32_t hands() const noexcept;
  /// [any] Organ, tools and tissue that the renderer draws.
  [[nodiscard]] render::Subject subject() const;
  /// [any] The row of one hand at a tick.
  [[nodiscard]] const haptics::TickRow& row(std::uint64_t tick, std::uint32_t hand) const;

  /// [any] Time of a tick [s].
  [[nodiscard]] double time_of(std::uint64_t tick) const noexcept;
  /// [any] Duration of the recording [s].
  [[nodiscard]] double duration_s() const noexcept { return time_of(ticks()); }
  /// [any] The tick closest to a time [s], clamped to the recording.
  [[nodiscard]] std::uint64_t tick_at(double time) const noexcept;

  /// [setup] Camera that shows the contact of a hand at its deepest tick. Without contact it shows the point
  /// of the organ closest to the tool. @param close_up the contact fills the picture
  [[nodiscard]] render::Camera camera(std::uint32_t hand, bool close_up);

 private:
  std::filesystem::path file_;
  record::Recording recording_;
  OrganPreparation preparation_;
  record::RecordingFrames frames_;
};

}  // namespace palpate::app
