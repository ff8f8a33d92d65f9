#include "palpate/fit/fit_many.h"

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/fit/fit_record.h"

namespace palpate::fit {
namespace {

constexpr double kPooledShare = 0.15;  // of the specimens' time, for the progress

/// One line a specimen, empty where it is still to be fitted.
using Lines = std::vector<std::string>;

class Fitting final {
 public:
  Fitting(std::vector<Specimen> specimens, const Settings& settings, Crew& crew, const Progress& progress)
      : specimens_(std::move(specimens)), settings_(settings), crew_(crew), progress_(progress) {}

  /// What the results file has already, the same on every member; rank 0 opens it to add to.
  void resume(const std::string& file) {
    lines_.resize(specimens_.size());
    std::string shared;
    if (crew_.rank() == 0 && !file.empty()) {
      const std::map<std::string, std::string> known = read_lines(file);
      for (std::size_t i = 0; i < specimens_.size(); ++i) {
        const auto line = known.find(key_of(specimens_[i], settings_, static_cast<std::uint32_t>(i)));
        if (line != known.end()) shared += std::to_string(i) + ' ' + line->second + '\n';
      }
      results_.open(file, std::ios::binary | std::ios::app);
      results_ << '\n';  // ends a line that was cut off
    }
    const bool writable =
        file.empty() || crew_.from_first(crew_.rank() == 0 && results_ ? "yes" : "no") == "yes";
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

  /// Every member takes specimens, each fitted by one of them.
  void by_specimen() {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].empty()) missing.push_back(i);
    }
    std::size_t done = lines_.size() - missing.size();
    const bool alone = crew_.size() == 1;
    const auto work = [&](std::size_t item) {
      const std::size_t i = missing[item];
      const Progress within = [&](double share, const std::string& what) {
        tell((static_cast<double>(done) + share), specimens_[i].name + ": " + what);
      };
      return fitted(i, alone ? within : Progress{}, nullptr);
    };
    const auto arrived = [&](std::size_t item, const std::string& line) {
      ++done;
      keep(line);
      tell(static_cast<double>(done), specimens_[missing[item]].name + ": done");
    };
    if (!missing.empty()) tell(static_cast<double>(done), "fits");
    const Lines found = crew_.share_out(missing.size(), work, arrived);
    for (std::size_t item = 0; item < missing.size(); ++item) lines_[missing[item]] = found[item];
  }

  /// All members fit each specimen together: the search alike, the bootstrap shared out.
  void by_resample() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (!lines_[i].empty()) continue;
      const Progress within = [&](double share, const std::string& what) {
        if (crew_.rank() == 0) tell(static_cast<double>(i) + share, specimens_[i].name + ": " + what);
      };
      lines_[i] = fitted(i, within, &crew_);
      if (crew_.rank() == 0) keep(lines_[i]);
    }
  }

  ManyFits finish() {
    ManyFits many;
    many.resumed = resumed_;
    for (const std::string& line : lines_) {
      if (line.front() == kFailed) throw InputError(line.substr(1));
      many.specimens.push_back(fit_of(line));
    }
    const auto count = static_cast<double>(lines_.size());
    const Progress pooled = [&](double share, const std::string& what) {
      if (crew_.rank() == 0) tell(count * (1.0 + kPooledShare * share), what);
    };
    many.pooled = fit_pooled(specimens_, many.specimens, settings_, pooled, &crew_);
    return many;
  }

  [[nodiscard]] std::size_t count() const noexcept { return specimens_.size(); }

 private:
  static constexpr char kFailed = '!';  // before a message; a line begins with {

  std::string fitted(std::size_t i, const Progress& progress, Crew* crew) const {
    const auto job = static_cast<std::uint32_t>(i);
    try {
      return line_of(key_of(specimens_[i], settings_, job),
                     fit_specimen(specimens_[i], settings_, job, progress, crew));
    } catch (const InputError& error) {
      return kFailed + std::string(error.what());
    }
  }

  /// Adds a finished specimen to the results file, at once.
  void keep(const std::string& line) {
    if (!results_.is_open() || line.front() == kFailed) return;
    results_ << line << std::endl;  // NOLINT(performance-avoid-endl): must be on the disk before the next
  }

  void tell(double done, const std::string& what) const {
    const double pooled = specimens_.size() > 1 ? kPooledShare : 0.0;
    if (progress_) progress_(done / (static_cast<double>(specimens_.size()) * (1.0 + pooled)), what);
  }

  std::vector<Specimen> specimens_;
  const Settings& settings_;
  Crew& crew_;
  const Progress& progress_;
  Lines lines_;
  std::size_t resumed_ = 0;
  std::ofstream results_;
};

}  // namespace

ManyFits fit_many(std::vector<Specimen> specimens, const Settings& settings, Crew& crew,
                  const std::string& results_file, const Progress& progress) {
  if (crew.size() > 1) {
    specimens = specimens_of(crew.from_first(crew.rank() == 0 ? bytes_of(specimens) : std::string()));
  }
  Fitting fitting(std::move(specimens), settings, crew, progress);
  fitting.resume(results_file);
  // fewer specimens than members, and some members would have nothing to do
  if (crew.size() > 1 && fitting.count() < 2 * static_cast<std::size_t>(crew.size()) &&
      settings.bootstrap > 0) {
    fitting.by_resample();
  } else {
    fitting.by_specimen();
  }
  return fitting.finish();
}

}  // namespace palpate::fit
