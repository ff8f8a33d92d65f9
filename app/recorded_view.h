#pragma once
#include <cstdint>
#include <filesystem>

#include "io/record/recording_frames.h"
#include "palpate/offscreen.h"
#include "palpate/recording.h"

#include "app/preparation.h"

namespace palpate::app {

/// A recording that is opened to be looked at: the same moments, seen from the same place, in a file, in a
/// film and in the viewer's window. One thread, unless said.
class RecordedView final {
 public:
  /// [setup] Reads the file and prepares its organ. @param no_cache the organ is prepared anew
  /// @throws InputError naming the file when it cannot be read or run again, or has no tick.
  RecordedView(std::filesystem::path file, bool no_cache, const record::Progress& progress = {});
  RecordedView(const RecordedView&) = delete;
  RecordedView& operator=(const RecordedView&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  [[nodiscard]] const record::Recording& recording() const noexcept { return recording_; }
  [[nodiscard]] record::RecordingFrames& frames() noexcept { return frames_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return frames_.ticks(); }
  [[nodiscard]] std::uint32_t hands() const noexcept;
  /// [any] Hands and organ as pictures need them.
  [[nodiscard]] render::Subject subject() const;
  /// [any] The row of one hand at a tick.
  [[nodiscard]] const haptics::TickRow& row(std::uint64_t tick, std::uint32_t hand) const;

  /// [any] Time of a tick [s], of the recording's end, and the tick that is shown at a time.
  [[nodiscard]] double time_of(std::uint64_t tick) const noexcept;
  [[nodiscard]] double duration_s() const noexcept { return time_of(ticks()); }
  [[nodiscard]] std::uint64_t tick_at(double time) const noexcept;

  /// [setup] Where a hand's contact is best seen from: at its deepest moment (without contact: its nearest).
  /// @param close_up the contact fills the picture
  [[nodiscard]] render::Camera camera(std::uint32_t hand, bool close_up);

 private:
  std::filesystem::path file_;
  record::Recording recording_;
  OrganPreparation preparation_;
  record::RecordingFrames frames_;
};

}  // namespace palpate::app
