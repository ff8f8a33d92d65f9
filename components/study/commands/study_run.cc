// `palpate study run`: one session of one participant.
#include <atomic>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "palpate/device.h"
#include "palpate/error.h"
#include "palpate/version.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/progress.h"
#include "app/session.h"
#include "study/commands/study_commands.h"
#include "study/screens/study_screens.h"
#include "study/session/run_session.h"
#include "study/session/simulated_person.h"

namespace palpate::app {
namespace {

struct StudyRunFlags {
  std::string folder;
  std::string participant;
  std::optional<int> session;
  std::string device;
  std::string observer;
  std::vector<std::string> markers;
  bool watch = false;
  bool no_cache = false;
};

/// @throws InputError without a display
std::unique_ptr<StudyScreens> open_screens(const study::StudyFolder& study, const std::string& participant,
                                           const std::atomic<bool>& stop) {
  StudyScreensOptions options;
  options.stop = &stop;
  options.title = study.study.name + ": " + participant;
  options.status_file = study.folder / (participant + "-status.txt");
  try {
    return std::make_unique<StudyScreens>(study.study, std::move(options));
  } catch (const NoWindow& error) {
    throw InputError(std::string(error.what()) +
                     ": a person's session needs a display; --observer KIND runs without one");
  }
}

// A folder holds people or simulated ones, since their data are analysed together.
void require_one_kind(study::StudyFolder& study, const std::string& observer) {
  if (observer.empty()) {
    if (!study.simulated) return study::require_ethics(study.study);
    throw InputError(study.folder.string() + ": is for simulated participants; prepare another for people");
  }
  (void)study::make_person(observer, 1, 0);  // refuses an unknown one
  if (study.simulated) return;
  for (const std::string& id : study.ids) {
    if (!file_exists(study.log_of(id))) continue;
    throw InputError(study.folder.string() + ": has data of people; prepare another folder for --observer");
  }
  study::mark_simulated(study);
}

int run_study(const StudyRunFlags& flags) {
  if (flags.watch && flags.observer.empty()) throw InputError("--watch: needs --observer");
  if (!flags.markers.empty() && !flags.observer.empty() && !flags.watch) {
    throw InputError("--markers: a session that --observer runs offline has no times: add --watch");
  }
  study::StudyFolder study = study::open_study(flags.folder);
  study::require_blind(study);
  const study::SealedKey key = study.key;
  if (study.program != kVersion) {
    report_message(fmt::format("{}: was prepared by palpate {}, this is {}: use one version for all sessions",
                               flags.folder, study.program, kVersion));
  }
  require_one_kind(study, flags.observer);
  study::SessionOptions options;
  options.participant = flags.participant;
  options.session = flags.session;
  options.device = flags.device;
  options.observer = flags.observer;
  if (!flags.markers.empty()) {
    options.markers = flags.markers;
    if (*options.markers == std::vector<std::string>{"none"}) options.markers->clear();
  }
  const OrganPreparation preparation(flags.no_cache);
  options.preparation = preparation.how();
  Progress bar("study");
  std::optional<StopOnSignal> signals;  // a hand may be held
  std::unique_ptr<StudyScreens> screens;
  if (flags.observer.empty() || flags.watch) {
    signals.emplace();
    screens = open_screens(study, flags.participant, signals->flag());
    options.screens = screens.get();
  } else {
    options.progress = [&bar](double share, const std::string& what) { bar.update(share, what); };
  }
  const study::SessionOutcome outcome = study::run_session(study, key, options);
  bar.clear();
  std::cout << fmt::format("{}, session {}: {} in {}, {} spoiled; {}\n", flags.participant, outcome.session,
                           counted(static_cast<std::size_t>(outcome.trials), "trial", "trials"),
                           counted(static_cast<std::size_t>(outcome.blocks), "block", "blocks"),
                           outcome.spoiled,
                           outcome.withdrawn  ? "withdrawn"
                           : outcome.complete ? "complete"
                                              : "not complete: the same command goes on");
  if (!outcome.markers_failure.empty()) {
    std::cout << "Markers are missing: " << outcome.markers_failure << "; the log has the block\n";
  }
  if (outcome.fault == 0) return kDone;
  std::cout << "The force is zero: " << haptics::describe(static_cast<haptics::Fault>(outcome.fault)) << '\n';
  return kFault;
}

}  // namespace

void add_study_run(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<StudyRunFlags>();
  CLI::App* command = study.add_subcommand("run", "Run a session of one participant, or go on with it");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--participant", flags->participant, "id, as `palpate study status` lists it")
      ->required();
  command->add_option("--session", flags->session, "number of the session; default: the next one");
  command->add_option("--device", flags->device, "KIND[:PATH] instead of the scene's device");
  command
      ->add_option("--markers", flags->markers,
                   "serial:PATH[@BAUD] or tcp:HOST:PORT (again for each), or none, instead of [markers]")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--observer", flags->observer,
                      "a simulated observer in the chair (see `palpate study simulate`); runs offline");
  command->add_flag("--watch", flags->watch,
                    "with --observer: in real time, with the windows; you answer their questions");
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->footer(
      "Examples:\n  palpate study run touch --participant PX7K2\n"
      "  palpate study run touch --participant PX7K2 --session 2 --device haply\n"
      "  palpate study run touch --participant PX7K2 --device haply --markers serial:/dev/ttyUSB0\n"
      "  palpate study run try --participant PX7K2 --observer sr\n"
      "  palpate study run try --participant PX7K2 --observer sr --watch\n"
      "Every finished trial is on the disk before the next begins. After a crash the same command goes on.\n"
      "Exit: 0 done, 2 bad input, 3 a fault was latched");
  command->callback([flags, &exit_code] { exit_code = run_study(*flags); });
}

}  // namespace palpate::app
