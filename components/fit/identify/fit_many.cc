#include "fit/identify/fit_many.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "run/tasks/for_each_task.h"

#include "fit/identify/fit_record.h"

namespace palpate::identify {
namespace {

constexpr double kPooledShare = 0.15;  // of the total time of the specimens' fits, for the progress

class Fitting final {
 public:
  Fitting(std::vector<Specimen> specimens, const Settings& settings, tasks::Communicator& ranks,
          const std::string& results_file, const Progress& progress)
      : specimens_(std::move(specimens)),
        settings_(settings),
        ranks_(ranks),
        progress_(progress),
        needs_lines_(ranks.size() > 1 || !results_file.empty()),
        record_(results_file, ranks, check_line),
        fits_(specimens_.size()) {}

  /// Each specimen is fitted by one rank, or by one thread of a single process.
  void by_specimen() {
    std::atomic<std::size_t> done = 0;
    const auto key = [&](std::size_t i) {
      return record_key(specimens_[i], settings_, static_cast<std::uint32_t>(i));
    };
    const auto run = [&](std::size_t i) {
      const Progress within = [&](double share, const std::string& what) {
        report_progress((static_cast<double>(done.load()) + share), specimens_[i].name + ": " + what);
      };
      return fitted(i, ranks_.size() == 1 ? within : Progress{}, nullptr);
    };
    const auto arrived = [&](std::size_t i) {
      report_progress(static_cast<double>(++done), specimens_[i].name + ": done");
    };
    if (ranks_.rank() == 0) report_progress(0.0, "fits");
    auto [lines, resumed] = for_each_task(&ranks_, {specimens_.size(), run, key, arrived, true}, &record_);
    lines_ = std::move(lines);
    resumed_ = resumed;
  }

  /// All ranks fit each specimen together: each repeats the search, and they share the bootstrap.
  void by_resample() {
    for (std::size_t i = 0; i < specimens_.size(); ++i) {
      const Progress within = [&](double share, const std::string& what) {
        if (ranks_.rank() == 0)
          report_progress(static_cast<double>(i) + share, specimens_[i].name + ": " + what);
      };
      const std::string* line =
          record_.find(record_key(specimens_[i], settings_, static_cast<std::uint32_t>(i)));
      lines_.push_back(line != nullptr ? *line : fitted(i, within, &ranks_));
      if (line == nullptr) record_.add(lines_.back());
      if (line != nullptr) ++resumed_;
    }
  }

  ManyFits finish() {
    ManyFits many;
    many.resumed = resumed_;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      many.specimens.push_back(needs_lines_ ? parse_record_line(lines_[i]) : std::move(*fits_[i]));
    }
    const auto count = static_cast<double>(specimens_.size());
    const Progress pooled = [&](double share, const std::string& what) {
      if (ranks_.rank() == 0) report_progress(count * (1.0 + kPooledShare * share), what);
    };
    many.pooled = fit_pooled(specimens_, many.specimens, settings_, pooled, &ranks_);
    return many;
  }

  [[nodiscard]] std::size_t count() const noexcept { return specimens_.size(); }

 private:
  /// Fits a specimen. @return its line for the results file and for other ranks; "" without both
  std::string fitted(std::size_t i, const Progress& progress, tasks::Communicator* ranks) {
    const auto job = static_cast<std::uint32_t>(i);
    fits_[i] = fit_specimen(specimens_[i], settings_, job, progress, ranks);
    return needs_lines_ ? record_line(record_key(specimens_[i], settings_, job), *fits_[i]) : std::string();
  }

  void report_progress(double done, const std::string& what) const {
    const std::lock_guard lock(progress_mutex_);
    const double pooled = specimens_.size() > 1 ? kPooledShare : 0.0;
    if (progress_) progress_(done / (static_cast<double>(specimens_.size()) * (1.0 + pooled)), what);
  }

  std::vector<Specimen> specimens_;
  const Settings& settings_;
  tasks::Communicator& ranks_;
  const Progress& progress_;
  mutable std::mutex progress_mutex_;
  bool needs_lines_;
  tasks::Record record_;
  std::vector<std::optional<SpecimenFit>> fits_;  // those of this rank
  std::vector<std::string> lines_;                // all, in the order of the specimens; each may be empty
  std::size_t resumed_ = 0;
};

}  // namespace

ManyFits fit_many(std::vector<Specimen> specimens, const Settings& settings, tasks::Communicator& ranks,
                  const std::string& results_file, const Progress& progress) {
  if (ranks.size() > 1) {
    specimens = specimens_of(ranks.broadcast(ranks.rank() == 0 ? bytes_of(specimens) : std::string()));
  }
  Fitting fitting(std::move(specimens), settings, ranks, results_file, progress);
  // with fewer than two specimens per rank, some ranks would be idle for long
  if (ranks.size() > 1 && fitting.count() < 2 * static_cast<std::size_t>(ranks.size()) &&
      settings.bootstrap > 0) {
    fitting.by_resample();
  } else {
    fitting.by_specimen();
  }
  return fitting.finish();
}

}  // namespace palpate::identify
