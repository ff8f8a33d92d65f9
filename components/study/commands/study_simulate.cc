// `palpate study simulate`: fills a prepared study with simulated participants.
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "palpate/error.h"
#include "run/tasks/for_each_task.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/progress.h"
#include "study/commands/study_commands.h"
#include "study/session/run_session.h"
#include "study/session/simulate.h"
#include "study/session/simulated_person.h"

namespace palpate::app {
namespace {

struct SimulateFlags {
  std::string folder;
  std::string observer = "ideal";
  int participants = 0;
  bool rendered = false;
  bool no_cache = false;
};

std::vector<std::string> participants_of(const study::StudyFolder& study, int wanted) {
  const auto prepared = static_cast<int>(study.ids.size());
  if (wanted > prepared) {
    throw InputError(fmt::format("--participants {}: {} has {}, prepare a folder with more of them", wanted,
                                 study.folder.string(), prepared));
  }
  const auto count = static_cast<std::ptrdiff_t>(wanted == 0 ? prepared : wanted);
  return {study.ids.begin(), study.ids.begin() + count};
}

// Nobody's data may lie beside simulated ones.
void require_empty(const study::StudyFolder& study) {
  for (const std::string& id : study.ids) {
    if (!file_exists(study.log_of(id))) continue;
    throw InputError(study.log_of(id).string() + ": is there already; simulate only fills an empty folder");
  }
}

// All sessions of one participant on the haptic loop, offline.
std::uint32_t run_rendered(const study::StudyFolder& study, study::SealedKey key, const std::string& id,
                           const std::string& observer, const contact::Preparation& preparation,
                           const std::function<void(double, const std::string&)>& progress) {
  const std::size_t sessions = study::plan_sessions(study.study, study.number_of(id)).size();
  for (std::size_t session = 0; session < sessions; ++session) {
    study::SessionOptions options;
    options.participant = id;
    options.observer = observer;
    options.preparation = preparation;
    options.progress = progress;
    const study::SessionOutcome outcome = study::run_session(study, key, options);
    if (outcome.fault != 0) return outcome.fault;
  }
  return 0;
}

int simulate(const SimulateFlags& flags) {
  (void)study::make_person(flags.observer, 1, 0);  // refuses an unknown one before anything is written
  study::StudyFolder study = study::open_study(flags.folder);
  const study::SealedKey key = study.key;
  const std::vector<std::string> ids = participants_of(study, flags.participants);
  const std::unique_ptr<tasks::Communicator> ranks = tasks::make_communicator();
  tasks::on_rank_zero(*ranks, [&] {
    require_empty(study);
    study::mark_simulated(study);
  });
  const OrganPreparation preparation(flags.no_cache);
  Progress bar("simulate");
  std::size_t finished = 0;
  tasks::Tasks work;
  work.count = ids.size();
  work.on_threads = !flags.rendered;
  work.run = [&](std::size_t i) {
    if (!flags.rendered) {
      return study::simulate_log(study, key, static_cast<std::uint32_t>(i), flags.observer);
    }
    const auto progress = [&](double share, const std::string& what) {
      if (ranks->rank() != 0) return;
      bar.update((static_cast<double>(i) + share) / static_cast<double>(ids.size()), ids[i] + ": " + what);
    };
    const std::uint32_t fault = run_rendered(study, key, ids[i], flags.observer, preparation.how(), progress);
    return fault == 0 ? std::string() : "fault " + std::to_string(fault);
  };
  work.done = [&](std::size_t i) {
    bar.update(static_cast<double>(++finished) / static_cast<double>(ids.size()), ids[i]);
  };
  const tasks::TaskResults logs = tasks::for_each_task(ranks.get(), work);
  if (ranks->rank() != 0) return kDone;
  bar.clear();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!flags.rendered) {
      study::keep_log(study, ids[i], logs.results[i]);
    } else if (!logs.results[i].empty()) {
      report_error(ids[i] + ": " + logs.results[i] + " ended a session");
      return kFault;
    }
  }
  report_message(fmt::format("{} simulated in {} as observer {}{}; next: palpate study analyse {}",
                             counted(ids.size(), "participant", "participants"), flags.folder, flags.observer,
                             flags.rendered ? ", with rendered force" : "", flags.folder));
  return kDone;
}

}  // namespace

void add_study_simulate(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<SimulateFlags>();
  CLI::App* command =
      study.add_subcommand("simulate", "Fill a prepared study with simulated participants, marked as such");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--observer", flags->observer,
                      "ideal, linear, sr (stochastic resonance), lapse, random, tires, learns or cue-user");
  command->add_option("--participants", flags->participants, "the first N of the folder; default: all")
      ->check(CLI::Range(1, 1000));
  command->add_flag(
      "--rendered", flags->rendered,
      "answer to the force that the haptic loop renders, with recordings; without it by formulas");
  add_jobs(*command);
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->footer(
      "Examples:\n  palpate study prepare touch-noise.toml try --participants 24\n"
      "  palpate study simulate try --observer sr\n"
      "  mpirun -n 8 palpate study simulate try --observer linear\n"
      "The logs are the same on any number of processes.");
  command->callback([flags, &exit_code] { exit_code = simulate(*flags); });
}

}  // namespace palpate::app
