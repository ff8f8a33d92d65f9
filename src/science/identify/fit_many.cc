#include "science/identify/fit_many.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "palpate/error.h"
#include "science/identify/fit_record.h"
#include "science/identify/result_lines.h"

namespace palpate::identify {
namespace {

constexpr double kPooledShare = 0.15;  // of the specimens' time, for the progress

class Fitting final {
 public:
  Fitting(std::vector<Specimen> specimens, const Settings& settings, Crew& crew,
          const std::string& results_file, const Progress& progress)
      : specimens_(std::move(specimens)),
        settings_(settings),
        crew_(crew),
        progress_(progress),
        lines_(
            specimens_.size(),
            [this](std::size_t i) { return key_of(specimens_[i], settings_, static_cast<std::uint32_t>(i)); },
            results_file, crew) {}

  /// Every member takes specimens, each fitted by one of them.
  void by_specimen() {
    std::size_t done = lines_.resumed();
    const bool alone = crew_.size() == 1;
    const auto work = [&](std::size_t i) {
      const Progress within = [&](double share, const std::string& what) {
        tell((static_cast<double>(done) + share), specimens_[i].name + ": " + what);
      };
      return fitted(i, alone ? within : Progress{}, nullptr);
    };
    const auto arrived = [&](std::size_t i, const std::string& line) {
      ++done;
      keep(line);
      tell(static_cast<double>(done), specimens_[i].name + ": done");
    };
    if (done < lines_.count()) tell(static_cast<double>(done), "fits");
    lines_.compute(work, arrived);
  }

  /// All members fit each specimen together: the search alike, the bootstrap shared out.
  void by_resample() {
    for (std::size_t i = 0; i < lines_.count(); ++i) {
      if (!lines_[i].empty()) continue;
      const Progress within = [&](double share, const std::string& what) {
        if (crew_.rank() == 0) tell(static_cast<double>(i) + share, specimens_[i].name + ": " + what);
      };
      lines_.set(i, fitted(i, within, &crew_));
      keep(lines_[i]);
    }
  }

  ManyFits finish() {
    ManyFits many;
    many.resumed = lines_.resumed();
    for (std::size_t i = 0; i < lines_.count(); ++i) {
      const std::string& line = lines_[i];
      if (line.front() == kFailed) throw InputError(line.substr(1));
      many.specimens.push_back(fit_of(line));
    }
    const auto count = static_cast<double>(lines_.count());
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

  /// A specimen that could not be fitted is tried again by the next call.
  void keep(const std::string& line) {
    if (line.front() != kFailed) lines_.keep(line);
  }

  void tell(double done, const std::string& what) const {
    const double pooled = specimens_.size() > 1 ? kPooledShare : 0.0;
    if (progress_) progress_(done / (static_cast<double>(specimens_.size()) * (1.0 + pooled)), what);
  }

  std::vector<Specimen> specimens_;
  const Settings& settings_;
  Crew& crew_;
  const Progress& progress_;
  ResultLines lines_;
};

}  // namespace

ManyFits fit_many(std::vector<Specimen> specimens, const Settings& settings, Crew& crew,
                  const std::string& results_file, const Progress& progress) {
  if (crew.size() > 1) {
    specimens = specimens_of(crew.from_first(crew.rank() == 0 ? bytes_of(specimens) : std::string()));
  }
  Fitting fitting(std::move(specimens), settings, crew, results_file, progress);
  // fewer specimens than members, and some members would have nothing to do
  if (crew.size() > 1 && fitting.count() < 2 * static_cast<std::size_t>(crew.size()) &&
      settings.bootstrap > 0) {
    fitting.by_resample();
  } else {
    fitting.by_specimen();
  }
  return fitting.finish();
}

}  // namespace palpate::identify
