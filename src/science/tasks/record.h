#pragma once
#include <cstddef>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "science/tasks/ranks.h"

namespace palpate::tasks {

/// Throws any exception for a line that is not a whole result.
using CheckLine = std::function<void(const std::string&)>;

/// [setup] The lines of a record by their keys; none of a file that is missing, and none of lines that are
/// cut off, have no "key" or that `check` refuses. @throws InputError when the file cannot be read
[[nodiscard]] std::map<std::string, std::string> read_record(const std::string& file, const CheckLine& check);

/// The results of finished tasks in a file: one JSON object with a member "key" a line. A calculation that
/// was broken off goes on from it. Every rank has the same results; rank 0 alone reads and writes the file.
class Record final {
 public:
  /// [setup] Every rank makes it at the same time. @param file empty: nothing is kept
  /// @throws InputError on every rank alike when the file cannot be read or written
  Record(std::string file, Ranks& ranks, const CheckLine& check);

  /// [setup] The line with this key; null when there is none.
  [[nodiscard]] const std::string* find(const std::string& key) const;
  /// [setup] Appends a line to the file, and to the disk, at once. Does nothing on other ranks than rank 0.
  void add(const std::string& line);
  /// [any] Why lines that were added are not in the file; empty: all are.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  std::map<std::string, std::string> lines_;
  std::string file_;
  std::ofstream out_;
  std::string failure_;
};

}  // namespace palpate::tasks
