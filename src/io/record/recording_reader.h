#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>

#include "io/record/hdf5_handle.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// Reads a file of RecordingWriter: complete, truncated or still being written. Only for the module record.
/// All functions throw InputError naming the file.
class RecordingReader final {
 public:
  /// [setup] Opens the file and reads everything except the ticks.
  explicit RecordingReader(std::filesystem::path file);
  ~RecordingReader() = default;
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  [[nodiscard]] const scene::Scene& scene() const noexcept { return scene_; }
  /// Moves the scene out; the last call on a reader.
  [[nodiscard]] scene::Scene&& take_setup() noexcept { return std::move(scene_); }
  [[nodiscard]] const RunFacts& facts() const noexcept { return facts_; }
  /// Updates of tissue and noise, in order; of a damaged file those before the damage.
  [[nodiscard]] const std::vector<haptics::ParameterUpdate>& changes() const noexcept { return changes_; }
  [[nodiscard]] std::uint64_t rows_lost() const noexcept { return rows_lost_; }
  /// Whether other HDF5 tools would reject the file.
  [[nodiscard]] bool cut_off() const noexcept { return cut_off_; }
  /// The number of rows that the file declares; fewer may be readable.
  [[nodiscard]] std::uint64_t rows_claimed() const noexcept { return rows_claimed_; }
  /// Whether a complete recording has fewer or more rows than were written. Older ones do not have the
  /// number.
  [[nodiscard]] bool rows_missing() const noexcept {
    return rows_written_ && *rows_written_ != rows_claimed_;
  }

  /// [setup] Passes the rows in order, block by block, up to the last complete tick before the first damage.
  /// @param strict throw on damage, unless the recording was cut off @return the number of rows
  std::uint64_t for_each_block(bool strict,
                               const std::function<void(std::span<const haptics::TickRow>)>& use);

 private:
  void open();
  bool open_as_is(int descriptor);
  bool open_filled_up(int descriptor);
  void read_all_but_ticks();
  void read_changes();
  [[nodiscard]] std::size_t rows_within_file(std::uint64_t start, std::size_t count) const;
  void read_block(std::uint64_t start, std::span<haptics::TickRow> rows);
  [[noreturn]] void refuse(const std::string& why) const;

  hdf5::SilenceErrors quiet_;
  std::filesystem::path path_;
  std::uint64_t file_bytes_ = 0;
  std::size_t row_bytes_ = 0;  // of a row in the file
  hdf5::Handle file_;
  hdf5::Handle row_type_;
  hdf5::Handle ticks_;
  scene::Scene scene_;
  RunFacts facts_;
  std::vector<haptics::ParameterUpdate> changes_;
  std::uint64_t rows_lost_ = 0;
  std::uint64_t rows_claimed_ = 0;
  std::optional<std::uint64_t> rows_written_;  // of a complete recording
  bool cut_off_ = false;
};

}  // namespace palpate::record
