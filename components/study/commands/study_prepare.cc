// `palpate study prepare`: makes the folder of a study.
#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "core/base/text.h"

#include "app/commands.h"
#include "app/numbers.h"
#include "study/commands/study_commands.h"
#include "study/session/folder.h"

namespace palpate::app {
namespace {

struct StudyPrepareFlags {
  std::string file;
  std::string folder;
  std::uint64_t participants = 0;
};

int prepare(const StudyPrepareFlags& flags) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
  study::prepare_study(flags.file, flags.folder, static_cast<int>(std::min(flags.participants, kMax)));
  const study::StudyFolder made = study::open_study(flags.folder);
  std::cout << fmt::format("{}: {} of study {}\n", flags.folder,
                           counted(made.ids.size(), "participant", "participants"), made.study.name);
  for (const std::string& id : made.ids) std::cout << id << '\n';
  std::cout << fmt::format("\nNext:\n  palpate study run {0} --participant {1}\n  palpate study status {0}\n",
                           flags.folder, made.ids.front());
  return kDone;
}

}  // namespace

void add_study_prepare(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<StudyPrepareFlags>();
  CLI::App* command =
      study.add_subcommand("prepare", "Make the folder of a study: copies, hashes, ids and the sealed key");
  command->add_option("study", flags->file, "The study file (.toml)")->required();
  command->add_option("folder", flags->folder, "A new or an empty folder")->required();
  add_whole(*command, "--participants", flags->participants, "number of people, from 1 to 999")->required();
  command->footer(
      "Examples:\n  palpate study prepare examples/study/touch-noise.toml touch --participants 24\n"
      "Study file, scene and consent text are copied and cannot be changed afterwards. sealed.json, which "
      "only you\n"
      "can read, holds the number that the conditions follow from.");
  command->callback([flags, &exit_code] { exit_code = prepare(*flags); });
}

}  // namespace palpate::app
