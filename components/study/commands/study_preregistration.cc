// `palpate study export --preregistration`: a text for a registry, from the prepared study alone.
#include <string>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/input_file.h"
#include "io/system/sha256.h"
#include "palpate/version.h"

#include "study/commands/study_commands.h"

namespace palpate::app {
namespace {

using study::Study;
using study::StudyTask;

std::string arms_text(const StudyTask& task) {
  std::string text;
  for (const study::Arm& arm : task.arms) {
    if (arm.name.empty()) return "one, without noise of its own";
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", arm.name,
                        arm.share == 0.0 ? "no noise" : brief(arm.share) + " x the own noise threshold");
  }
  return text;
}

std::string tasks_text(const Study& study) {
  std::string text;
  for (const StudyTask& task : study.tasks) {
    text += fmt::format(
        "- {} ({}): {} a condition, {} % of them catch trials. Conditions: {}.{}{}\n", task.name,
        describe(task.kind).name, counted(static_cast<std::size_t>(task.trials), "trial", "trials"),
        brief(100.0 * task.catch_share), arms_text(task),
        task.practice_until
            ? fmt::format(" Practice until {} of {} are correct, {} at most.", task.practice_until->correct,
                          task.practice_until->of, task.practice_until->most)
            : "",
        task.each_session ? " Measured again at the start of each session, whose noise it sets." : "");
  }
  return text + (study.latin_order
                     ? "- Tasks that nothing depends on: in the orders of a Williams square, in turn.\n"
                     : "- Tasks in this order.\n");
}

std::string hypothesis_text(const Study& study) {
  std::string text;
  if (study.primary) {
    const study::PrimaryAnalysis& primary = *study.primary;
    text += fmt::format("- Primary: {} in task {}, {} - {}, {} at 5 %.\n", primary.measure, primary.task,
                        primary.condition, primary.reference,
                        primary.alternative == "two-sided" ? "two-sided test"
                                                           : "one-sided test (" + primary.alternative + ")");
  } else {
    text += "- No primary analysis: all results are exploratory.\n";
  }
  if (study.inverted_u) {
    text += fmt::format("- Inverted U in task {}: both one-sided tests must reject at {}.\n",
                        study.inverted_u->task, percent(study.inverted_u->alpha, 0));
  }
  if (!study.own_level.empty()) {
    text += fmt::format(
        "- Own level in task {}: each person's best noise is chosen in one half of the trials and tested "
        "against no noise in the other, both ways round.\n",
        study.own_level);
  }
  return text + "- All other contrasts are exploratory, adjusted by Holm within a task.\n";
}

}  // namespace

std::string preregistration_text(const study::StudyFolder& folder) {
  const Study& study = folder.study;
  std::string text = fmt::format(
      "# Preregistration: {}\n\nMade by palpate {} from a prepared study. Nothing here comes from an "
      "answer.\n\n"
      "## Hypotheses and tests\n{}\n## Design\nScene {}. {} of at most {} min. Seed {}. The experimenter and "
      "the participants are blind to the conditions, whose codes are drawn for each participant.\n{}\n"
      "## Number of participants\n{}, fixed when the study was prepared. Nobody looks at a condition before "
      "all have finished; ending earlier needs `unblind --early`, which is logged.\n\n"
      "## Exclusions, fixed before\n- {}\n- who withdraws is in no analysis\n- both analyses, with and "
      "without excluded people, are "
      "reported\n- people whose threshold leaves the stimuli stay in the group's likelihood\n\n",
      study.name, kVersion, hypothesis_text(study), study.scene,
      counted(static_cast<std::size_t>(study.sessions), "session", "sessions"), shortest(study.max_minutes),
      study.seed, tasks_text(study), counted(folder.ids.size(), "person", "people"),
      joined(study::exclusion_rules(study), "\n- "));
  text += "## SHA-256 of the registered files\n";
  text += fmt::format("- lock.json {}\n", folder.lock_hash);
  constexpr InputKind kLocked{"a file of the study", std::uint64_t{1} << 30U};
  for (const std::string& file : folder.files) {
    text += fmt::format("- {} {}\n", file, sha256(InputFile(folder.folder / file, kLocked).read_rest()));
  }
  return text + fmt::format("\n## Ethics\nApproval: {}.\n",
                            study.approval.empty() ? "none stated in the study file" : study.approval);
}

}  // namespace palpate::app
