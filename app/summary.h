#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "net/igtl_clients.h"
#include "palpate/recording.h"
#include "palpate/session.h"
#include "run/palpation/insertion_score.h"
#include "run/palpation/score.h"

namespace palpate::app {

/// Files and folder of a run's outputs; empty: not requested.
struct OutputFiles {
  std::filesystem::path recording;
  std::filesystem::path report;
  std::filesystem::path screenshot;
};

[[nodiscard]] inline double microseconds(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

/// [setup] p50, p99, p99.9 (key "p999") and maximum of times [us].
[[nodiscard]] nlohmann::ordered_json to_json(const haptics::Histogram& times);

/// [setup] Remarks on a run as text: repairs and remarks of the scene, remarks of the loop, and the meaning
/// of the status bits.
[[nodiscard]] std::vector<std::string> remarks(const session::RunResult& run);

/// [setup] The document that `palpate run --json` prints (docs/file-formats.md). @param igtl statistics of
/// the OpenIGTLink server; nullopt: no server
[[nodiscard]] nlohmann::ordered_json summary_json(
    const session::RunResult& run, const OutputFiles& files,
    const std::optional<net::IgtlStatistics>& igtl = std::nullopt);

/// [setup] Prints a readable summary of a run.
void print_summary(std::ostream& out, const session::RunResult& run, const OutputFiles& files);

/// [setup] Scores a recording, with a progress bar. @throws InputError as scene::make_world()
[[nodiscard]] palpation::ScoredRecording score_of(const record::Recording& recording, bool no_cache);

/// [setup] As score_of(); a recording of task insert gets an InsertionScore.
[[nodiscard]] palpation::AnyScore any_score_of(const record::Recording& recording, bool no_cache);

/// [setup] Prints a score as text.
void print_score(std::ostream& out, const palpation::AnyScore& score);

}  // namespace palpate::app
