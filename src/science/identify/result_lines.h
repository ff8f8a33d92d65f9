#pragma once
#include <cstddef>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "science/identify/crew.h"

namespace palpate::identify {

/// What a crew's items give, one line each, and the file that keeps the lines as they come: a call that was
/// broken off goes on from there.
class ResultLines final {
 public:
  /// [setup] Takes what the file has already, the same on every member; rank 0 opens it to add to.
  /// @param key_of an item's key in the file @param file none when empty
  /// @throws InputError when the file cannot be written
  ResultLines(std::size_t items, const std::function<std::string(std::size_t)>& key_of,
              const std::string& file, Crew& crew);

  [[nodiscard]] std::size_t count() const noexcept { return lines_.size(); }
  /// [setup] How many the file had already.
  [[nodiscard]] std::size_t resumed() const noexcept { return resumed_; }
  /// [setup] The line of an item; empty where it is still to be computed.
  [[nodiscard]] const std::string& operator[](std::size_t item) const { return lines_[item]; }

  /// [setup] Sets an item's line. Not the file's.
  void set(std::size_t item, std::string line) { lines_[item] = std::move(line); }
  /// [setup] Adds a line to the file, at once. Does nothing on other members than rank 0.
  void keep(const std::string& line);
  /// [setup] Shares the items without a line out among the crew: `work` gives an item's line, and `arrived`
  /// is called on rank 0 for each that is there.
  void compute(const Crew::Work& work, const Crew::Arrived& arrived);

 private:
  Crew& crew_;
  std::vector<std::string> lines_;
  std::size_t resumed_ = 0;
  std::ofstream file_;
};

}  // namespace palpate::identify
