// `palpate study power`: power of a study's registered analysis, by simulation.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "palpate/error.h"
#include "run/tasks/communicator.h"

#include "app/commands.h"
#include "app/numbers.h"
#include "app/progress.h"
#include "study/commands/study_commands.h"
#include "study/session/power.h"

namespace palpate::app {
namespace {

struct PowerFlags {
  std::string study;
  std::vector<std::string> effects;
  study::PowerRequest request;
  bool as_json = false;
};

/// Reads "jnd=0.85" or "sr=0.4". @throws InputError
void read_effect(const std::string& text, study::PowerRequest& request) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::optional<double> value =
      equals == std::string::npos ? std::nullopt : palpate::parse_number(text.substr(equals + 1));
  if ((name != "jnd" && name != "sr") || !value) {
    throw InputError("--effect `" + text +
                     "`: must be jnd=RATIO or sr=NOISE, for example jnd=0.85 or sr=0.4");
  }
  (name == "jnd" ? request.jnd_ratio : request.internal_noise) = *value;
}

int power(PowerFlags& flags) {
  for (const std::string& effect : flags.effects) read_effect(effect, flags.request);
  const study::Study study = study::load_study(flags.study);
  const std::unique_ptr<tasks::Communicator> ranks = tasks::make_communicator();
  study::Power found;
  {
    Progress bar("power", WithoutTerminal::kLines);
    found = study::simulate_power(study, flags.request, ranks.get(),
                                  [&bar](double share) { bar.update(share, "simulated groups"); });
  }
  if (ranks->rank() != 0) return kDone;
  std::cout << (flags.as_json ? study::power_json(study, found) : study::power_text(study, found));
  return kDone;
}

}  // namespace

void add_study_power(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<PowerFlags>();
  CLI::App* command = study.add_subcommand(
      "power", "Simulate the registered analysis: power and interval for several numbers of participants");
  command->add_option("study", flags->study, "study file (.toml)")->required();
  command
      ->add_option("--effect", flags->effects,
                   "jnd=RATIO of the JNDs of the primary contrast, or sr=NOISE, the internal noise of the "
                   "observer sr as a share of its threshold; repeat the flag for both. Default: jnd=0.85 and "
                   "sr=0.4, as far as the study analyses them")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--participants", flags->request.participants, "numbers of people, default 12,16,24")
      ->delimiter(',');
  command->add_option("--groups", flags->request.groups, "simulated groups, default 200");
  add_jobs(*command);
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n"
      "  palpate study power touch-noise.toml\n"
      "  palpate study power touch-noise.toml --effect jnd=0.8 --participants 16,24,32 --groups 400\n"
      "  mpirun -n 8 palpate study power touch-noise.toml --effect sr=0.35 --json\n"
      "The table says whether its test is one- or two-sided, and is the same on any number of threads and\n"
      "processes.\n"
      "Exit: 0 done, 2 bad input");
  command->callback([flags, &exit_code] { exit_code = power(*flags); });
}

}  // namespace palpate::app
