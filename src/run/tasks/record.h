#pragma once
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "run/tasks/communicator.h"

namespace palpate::tasks {

/// Throws any exception for a line that is not a complete result.
using CheckLine = std::function<void(const std::string&)>;

/// [setup] Lines of a record by key. A missing file gives none; truncated lines, lines without "key" and
/// lines that `check` rejects are skipped. @throws InputError when the file cannot be read
[[nodiscard]] std::map<std::string, std::string> read_record(const std::string& file, const CheckLine& check);

/// File of finished tasks' results: one JSON object with a member "key" per line. An interrupted calculation
/// continues from it. All ranks have the same results; only rank 0 reads and writes the file.
class Record final {
 public:
  /// [setup] All ranks must construct it together. @param file empty: nothing is recorded @throws InputError
  /// on all ranks when the file cannot be read or written
  Record(std::string file, Communicator& ranks, const CheckLine& check);

  /// [setup] The line with this key; null when the key is not in the record.
  [[nodiscard]] const std::string* find(const std::string& key) const;
  /// [setup] Appends a line and flushes it to the disk. No effect on ranks other than 0.
  void add(const std::string& line);
  /// [any] Why added lines are not in the file; empty: all are.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  std::map<std::string, std::string> lines_;
  std::string file_;
  std::ofstream out_;
  std::string failure_;
};

}  // namespace palpate::tasks
