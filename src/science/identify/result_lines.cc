#include "science/identify/result_lines.h"

#include <map>

#include "palpate/error.h"
#include "science/identify/fit_record.h"

namespace palpate::identify {

ResultLines::ResultLines(std::size_t items, const std::function<std::string(std::size_t)>& key_of,
                         const std::string& file, Crew& crew)
    : crew_(crew), lines_(items) {
  std::string shared;
  if (crew_.rank() == 0 && !file.empty()) {
    const std::map<std::string, std::string> known = read_lines(file);
    for (std::size_t i = 0; i < items; ++i) {
      const auto line = known.find(key_of(i));
      if (line != known.end()) shared += std::to_string(i) + ' ' + line->second + '\n';
    }
    file_.open(file, std::ios::binary | std::ios::app);
    file_ << '\n';  // ends a line that was cut off
  }
  const bool writable = file.empty() || crew_.from_first(crew_.rank() == 0 && file_ ? "yes" : "no") == "yes";
  if (!writable) throw InputError("--out: the results beside it, " + file + ", cannot be written");
  shared = crew_.from_first(std::move(shared));
  for (std::size_t at = 0; at < shared.size();) {
    const std::size_t space = shared.find(' ', at);
    const std::size_t end = shared.find('\n', space);
    lines_[std::stoul(shared.substr(at, space - at))] = shared.substr(space + 1, end - space - 1);
    at = end + 1;
    ++resumed_;
  }
}

void ResultLines::keep(const std::string& line) {
  if (file_.is_open())
    file_ << line << std::endl;  // NOLINT(performance-avoid-endl): on the disk before the next
}

void ResultLines::compute(const Crew::Work& work, const Crew::Arrived& arrived) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].empty()) missing.push_back(i);
  }
  const std::vector<std::string> found = crew_.share_out(
      missing.size(), [&](std::size_t i) { return work(missing[i]); },
      [&](std::size_t i, const std::string& line) { arrived(missing[i], line); });
  for (std::size_t i = 0; i < missing.size(); ++i) lines_[missing[i]] = found[i];
}

}  // namespace palpate::identify
