// `palpate score`: scores the search of a recording for hidden inclusions.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/recording.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/preparation.h"
#include "app/score_summary.h"
#include "app/session.h"

namespace palpate::app {
namespace {

struct ScoreFlags {
  std::string file;
  std::string map;
  bool json = false;
  bool no_cache = false;
};

int score_file(const ScoreFlags& flags) {
  require_no_overwrite(std::vector<NamedFile>{{"--map", flags.map}},
                       std::vector<NamedFile>{{"the recording", flags.file}});
  if (!flags.map.empty()) require_writable_file(flags.map, "--map");
  const record::Recording recording = record::read_recording(flags.file);
  if (recording.rows.empty()) throw InputError(flags.file + ": has no tick, must have at least one");
  std::unique_ptr<haptics::SimulationWorld> world;
  const palpation::Scorer made = score_of(recording, flags.no_cache, world);
  if (!flags.map.empty()) palpation::write_map(made.map(), flags.map);
  if (flags.json) {
    std::cout << palpation::to_json(made.score()) << '\n';
  } else {
    print_score(std::cout, made.score());
  }
  return kDone;
}

}  // namespace

void add_score(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ScoreFlags>();
  CLI::App* command = program.add_subcommand(
      "score", "Score a search for hidden lumps: found, missed, coverage, force; and map the felt stiffness");
  command->add_option("recording", flags->file, "The recording (.h5)")->required();
  command->add_option("--map", flags->map,
                      "write the felt and the true stiffness over the organ's surface to this CSV file");
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->add_flag("--json", flags->json, "print one JSON document");
  command->footer(
      "Examples:\n  palpate run --task palpate --device mouse --record search.h5\n"
      "  palpate score search.h5 --map felt.csv\n"
      "A hand marks a place by a button, M in the window. docs/lumps.md defines every number.");
  command->callback([flags, &exit_code] { exit_code = score_file(*flags); });
}

}  // namespace palpate::app
