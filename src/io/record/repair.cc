#include <cerrno>
#include <cstring>
#include <exception>
#include <string>
#include <system_error>

#include "io/record/recording_reader.h"
#include "io/record/recording_writer.h"
#include "io/system/files.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"
#include "palpate/recording.h"

namespace palpate::record {
namespace {

/// Holds a lock on a file that nobody writes.
class OnlyUser final {
 public:
  explicit OnlyUser(const std::filesystem::path& file)
      : fd_(open_file(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
    if (fd_ >= 0 && !lock_file(fd_, FileLock::kExclusive)) {
      ::close(fd_);
      throw InputError(to_text(file) +
                       ": is open in another program, which writes or reads it: close it there first");
    }
  }
  ~OnlyUser() { release(); }
  OnlyUser(const OnlyUser&) = delete;
  OnlyUser& operator=(const OnlyUser&) = delete;
  void release() noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_ = -1;
};

/// Copies the rows that `reader` can read into a new file. @return their number
std::uint64_t copy_recording(RecordingReader& reader, const std::filesystem::path& copy,
                             const Progress& progress) {
  RunFacts facts = reader.facts();
  facts.complete = false;  // rows are missing
  RecordingWriter writer(copy, reader.scene(), facts);
  std::uint64_t rows = 0;
  try {
    writer.append(reader.changes());
    (void)reader.for_each_block(false, [&](std::span<const haptics::TickRow> block) {
      writer.append(block);
      rows += block.size();
      if (progress) progress(static_cast<double>(rows) / static_cast<double>(reader.rows_claimed()));
    });
    writer.write_summary(facts, reader.rows_lost());
    writer.flush(true);
    writer.close();
  } catch (...) {
    writer.abandon();
    throw;
  }
  return rows;
}

}  // namespace

RepairResult repair_recording(const std::filesystem::path& file, const Progress& progress) {
  // Only checks for a writer: HDF5 takes its own lock when it reads.
  OnlyUser(file).release();
  RecordingReader reader(file);
  const std::uint64_t rows = reader.for_each_block(false, [](std::span<const haptics::TickRow>) {});
  const bool whole = rows == reader.rows_claimed() && !reader.rows_missing();
  if (!reader.cut_off() && whole) return {rows, false};

  const std::filesystem::path target = std::filesystem::canonical(file);
  std::string copy = to_text(target.parent_path() / to_path("." + to_text(target.filename()) + ".partial."));
  const int descriptor = open_temporary_file(copy);
  if (descriptor < 0) {
    throw InputError(to_text(file) + ": cannot be repaired, the file is unchanged: " + std::strerror(errno));
  }
  ::close(descriptor);
  std::error_code ignored;
  try {
    RepairResult result{copy_recording(reader, to_path(copy), progress), true};
    const std::filesystem::perms rights = std::filesystem::status(target, ignored).permissions();
    if (!ignored) std::filesystem::permissions(to_path(copy), rights, ignored);
    std::filesystem::rename(to_path(copy), target);
    return result;
  } catch (const InputError&) {
    std::filesystem::remove(to_path(copy), ignored);
    throw;
  } catch (const std::exception& error) {
    std::filesystem::remove(to_path(copy), ignored);
    throw InputError(to_text(file) + ": cannot be repaired, the file is unchanged: " + error.what());
  }
}

}  // namespace palpate::record
