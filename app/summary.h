#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "net/igtl_clients.h"
#include "palpate/session.h"

namespace palpate::app {

/// Where a run's outputs are; empty: not asked for.
struct OutputFiles {
  std::filesystem::path recording;
  std::filesystem::path report;
  std::filesystem::path screenshot;
};

[[nodiscard]] inline double microseconds(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

/// [setup] p50, p99, p999 and max of times [us].
[[nodiscard]] nlohmann::ordered_json to_json(const haptics::Histogram& times);

/// [setup] What is wrong or worth knowing, in words: the scene's repairs and remarks, the loop's, what the
/// status bits say.
[[nodiscard]] std::vector<std::string> remarks(const session::RunResult& run);

/// [setup] The document that `palpate run --json` prints (docs/file-formats.md). @param igtl what --igtl did;
/// none: it was not asked for
[[nodiscard]] nlohmann::ordered_json summary_json(
    const session::RunResult& run, const OutputFiles& files,
    const std::optional<net::IgtlStatistics>& igtl = std::nullopt);

/// [setup] The same for people.
void print_summary(std::ostream& out, const session::RunResult& run, const OutputFiles& files);

}  // namespace palpate::app
