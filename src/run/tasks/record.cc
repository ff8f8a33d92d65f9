#include "run/tasks/record.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::tasks {

std::map<std::string, std::string> read_record(const std::string& file, const CheckLine& check) {
  std::map<std::string, std::string> lines;
  if (!file_exists(to_path(file))) return lines;
  std::istringstream in(InputFile(to_path(file), kTaskRecordInput).read_rest());
  for (std::string line; std::getline(in, line);) {
    try {
      std::string key = parse_json(line).at("key").get<std::string>();
      check(line);
      lines[std::move(key)] = line;
    } catch (const std::exception&) {
      continue;  // truncated: its task runs again
    }
  }
  return lines;
}

Record::Record(std::string file, Communicator& ranks, const CheckLine& check) : file_(std::move(file)) {
  std::string text;
  on_rank_zero(ranks, [&] {
    if (file_.empty()) return;
    lines_ = read_record(file_, check);
    out_.open(to_path(file_), std::ios::binary | std::ios::app);
    out_ << '\n' << std::flush;  // terminates a line that was truncated
    if (!out_) throw InputError(file_ + ": cannot be written");
    for (const auto& [key, line] : lines_) text += key + '\n' + line + '\n';
  });
  std::istringstream in(ranks.broadcast(std::move(text)));
  for (std::string key, line; std::getline(in, key) && std::getline(in, line);) lines_[key] = line;
}

const std::string* Record::find(const std::string& key) const {
  const auto found = lines_.find(key);
  return found == lines_.end() ? nullptr : &found->second;
}

void Record::add(const std::string& line) {
  if (!out_.is_open() || !failure_.empty()) return;
  errno = 0;
  out_ << line << std::endl;  // NOLINT(performance-avoid-endl): on disk before the next
  if (out_) return;
  const std::string why = errno == 0 ? "" : std::string(": ") + std::strerror(errno);
  failure_ = file_ + ": cannot be written any more" + why + "; what was finished since is not in it";
}

}  // namespace palpate::tasks
