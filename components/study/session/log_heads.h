#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate::study {

/// The end of a log.
struct LogHead {
  std::uint64_t lines = 0;
  std::string mac;  // of the last line; of an empty log: the lock's hash

  bool operator==(const LogHead&) const = default;
};

/// The file heads.txt of a study: a line for the study itself, then one for each participant's log, in which
/// the log's last line is authenticated. So lines at the end of a log cannot be removed unseen. Lines have a
/// fixed length and are written in place, after the log's own line is on the disk.
class LogHeads final {
 public:
  static constexpr const char* kName = "heads.txt";
  enum class Use {
    kRead,
    kAppend,  // locked, shared with other writers of logs
    kUnblind  // locked, not shared
  };

  /// [setup] @throws InputError when the file is missing or cannot be locked
  explicit LogHeads(std::filesystem::path file, Use use = Use::kRead);
  ~LogHeads();
  LogHeads(const LogHeads&) = delete;
  LogHeads& operator=(const LogHeads&) = delete;

  /// [setup] @param line from 0: 0 of the study, 1 and more of the participants @throws InputError naming the
  /// line when its mac does not fit
  [[nodiscard]] LogHead read(std::size_t line, const std::string& mac_key) const;
  /// [setup] Not flushed to the disk: after a power failure the head may be an earlier one. @throws
  /// InputError when it cannot be written
  void write(std::size_t line, const LogHead& head, const std::string& mac_key) const;

  /// [setup] Brings all lines to the disk. @throws InputError when that fails
  void flush() const;

  /// [any] The line that read() accepts.
  [[nodiscard]] static std::string text_of(const LogHead& head, const std::string& mac_key);

 private:
  void lock(Use use) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace palpate::study
