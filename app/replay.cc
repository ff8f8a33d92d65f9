// `palpate replay`: computes the ticks of a recording again from its device samples and compares the rows.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/recording.h"

#include "app/commands.h"
#include "app/output.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

struct ReplayFlags {
  std::filesystem::path file;
  bool verify = false;
  bool json = false;
  bool no_cache = false;
};

std::string hexadecimal(std::uint64_t value) { return fmt::format("{:016x}", value); }

void print_json(const record::Recording& recording, const record::ReplayResult& result, std::uint64_t ticks) {
  nlohmann::ordered_json json;
  json["ticks"] = ticks;
  json["hands"] = recording.scene.tools.size();
  json["complete"] = recording.facts.complete;
  json["rows_compared"] = result.rows_compared;
  json["rows_different"] = result.rows_different;
  json["identical"] = result.rows_different == 0;
  json["first_difference"] = nullptr;
  if (!result.first_difference.empty()) json["first_difference"] = result.first_difference;
  json["hash"] = hexadecimal(result.hash);
  std::cout << json_text(json) << '\n';
}

void print_text(const record::Recording& recording, const record::ReplayResult& result, std::uint64_t ticks,
                bool verify) {
  std::cout << "ticks  " << ticks << (recording.facts.complete ? "" : "  (the recording was cut off)") << '\n'
            << "hash   " << hexadecimal(result.hash) << '\n';
  if (result.rows_different == 0) {
    std::cout << "same   all " << result.rows_compared << " rows, bit for bit\n";
    return;
  }
  std::cout << (verify ? "DIFFERS " : "differs ") << result.rows_different << " of " << result.rows_compared
            << " rows; first: " << result.first_difference << '\n';
}

record::ReplayResult run_again(const record::Recording& recording, const std::filesystem::path& file,
                               Progress& bar, bool no_cache) {
  try {
    const OrganPreparation preparation(no_cache);
    return record::replay(
        recording, [&](double share) { bar.update(0.2 + 0.8 * share, "running the ticks again"); },
        preparation.how());
  } catch (const InputError& error) {
    throw InputError(to_text(file) + ": " + error.what());
  }
}

int replay_file(const ReplayFlags& flags) {
  Progress bar("replay");
  const record::Recording recording = record::read_recording(
      flags.file, [&](double share) { bar.update(0.2 * share, "reading " + to_text(flags.file)); },
      record::Blind::kAllow);
  const record::ReplayResult result = run_again(recording, flags.file, bar, flags.no_cache);
  const std::uint64_t ticks = result.rows_compared / recording.scene.tools.size();
  if (flags.json) {
    print_json(recording, result, ticks);
  } else {
    print_text(recording, result, ticks, flags.verify);
  }
  return flags.verify && result.rows_different > 0 ? kGoalMissed : kDone;
}

}  // namespace

void add_replay(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ReplayFlags>();
  CLI::App* command = program.add_subcommand(
      "replay", "Compute a recording's ticks again from its device samples, and compare every value");
  command->add_option("recording", flags->file, "The recording (.h5)")->required();
  command->add_flag("--verify", flags->verify, "Exit with 4 when any value differs in any bit");
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->add_flag("--json", flags->json, "Print one JSON document");
  command->footer("Examples:\n  palpate replay run.h5\n  palpate replay run.h5 --verify --json");
  command->callback([flags, &exit_code] { exit_code = replay_file(*flags); });
}

}  // namespace palpate::app
