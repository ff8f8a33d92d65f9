#include "study/report/study_report_sections.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"

#include "study/session/analysis_text.h"

namespace palpate::report {
namespace {

using study::ArmResult;
using study::PersonResult;
using study::Study;
using study::StudyAnalysis;
using study::StudyTask;

// A factor with its interval, from log10.
std::string factor_text(const psychophysics::Estimate& log10_factor, double by = 1.0) {
  const auto value = [by](double x) { return fixed(by * std::pow(10.0, x), 2); };
  return unbroken(fmt::format("{} ({} to {})", value(log10_factor.mean), value(log10_factor.low),
                              value(log10_factor.high)));
}

// Bias of the answers between the intervals, over all arms.
std::string criterion_text(const std::vector<ArmResult>& arms) {
  psychophysics::Count first;
  psychophysics::Count second;
  for (const ArmResult& arm : arms) {
    first.trials += arm.in_first.trials;
    first.counted += arm.in_first.counted;
    second.trials += arm.in_second.trials;
    second.counted += arm.in_second.counted;
  }
  if (first.trials == 0 || second.trials == 0) return "";
  return fmt::format("{:+.2f}", psychophysics::two_interval(first, second, true).criterion);
}

std::string halves_text(const StudyTask& task, const ArmResult& arm) {
  if (!is_number(arm.first_half) || !is_number(arm.second_half)) return "-";
  const auto value = [&](const std::optional<study::ThresholdFit>& fit) {
    return brief(readable_estimate(task, fit->estimate.mean).value, 3);
  };
  return value(arm.first_half) + ", " + value(arm.second_half);
}

std::string sensitivity_text(const ArmResult& arm) {
  if (!arm.sensitivity) return "-";
  return fmt::format("{:.2f}{}", arm.sensitivity->d_prime,
                     arm.sensitivity->reliable ? "" : " (no statement)");
}

std::string range_text(const std::vector<double>& values, int digits) {
  if (values.empty()) return "-";
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("{} ({} to {})", fixed(median(values), digits), fixed(*low, digits),
                     fixed(*high, digits));
}

// One row for each person and arm of a task with a function of the level.
TableRows function_rows(const StudyTask& task, const StudyAnalysis& analysis, std::size_t index) {
  TableRows rows{{"person", "condition", "trials", task.comparison() ? "JND" : "threshold", "halves",
                  "lapses", "bias c"}};
  if (task.repeat_at_end) rows[0].emplace_back("at the end");
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    const std::vector<ArmResult>& arms = person.tasks[index].arms;
    for (std::size_t i = 0; i < arms.size(); ++i) {
      rows.push_back({i == 0 ? escaped(person.id) : "", escaped(arm_text(analysis.tasks[index], i)),
                      std::to_string(arms[i].trials), unbroken(estimate_text(task, arms[i].fit)),
                      unbroken(halves_text(task, arms[i])),
                      arms[i].fit ? unbroken(percent(arms[i].fit->function.lapse, 0)) : "-",
                      i == 0 ? criterion_text(arms) : ""});
      if (!task.repeat_at_end) continue;
      rows.back().push_back(arms[i].repeated ? unbroken(estimate_text(task, arms[i].repeated)) : "-");
    }
  }
  return rows;
}

// One row for each person: d' in each arm.
TableRows sensitivity_rows(const StudyAnalysis& analysis, std::size_t index) {
  TableRows rows{{"person"}};
  for (std::size_t arm = 0; arm < analysis.tasks[index].arms.size(); ++arm) {
    rows[0].push_back("d', " + escaped(arm_text(analysis.tasks[index], arm)));
  }
  rows[0].emplace_back("bias c");
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    rows.push_back({escaped(person.id)});
    for (const ArmResult& arm : person.tasks[index].arms) rows.back().push_back(sensitivity_text(arm));
    rows.back().push_back(criterion_text(person.tasks[index].arms));
  }
  return rows;
}

TableRows control_rows(const StudyAnalysis& analysis, std::size_t index) {
  TableRows rows{{"person"}};
  for (std::size_t arm = 0; arm < analysis.tasks[index].arms.size(); ++arm) {
    rows[0].push_back(escaped(arm_text(analysis.tasks[index], arm)) + ": RMS error, variation");
  }
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    rows.push_back({escaped(person.id)});
    for (const ArmResult& arm : person.tasks[index].arms) {
      rows.back().push_back(arm.ln_rms && arm.ln_variation
                                ? fmt::format("{} N, {}", brief(std::exp(*arm.ln_rms), 3),
                                              percent(std::exp(*arm.ln_variation), 1))
                                : "-");
    }
  }
  return rows;
}

TableRows spoiled_rows(const Study& study, const StudyAnalysis& analysis) {
  TableRows rows{{"task", "condition", "trials", "spoiled", "share", "reasons", "response time, median"}};
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    for (std::size_t i = 0; i < study.tasks[task].arms.size(); ++i) {
      int trials = 0;
      int spoiled = 0;
      std::map<std::string, int> reasons;
      std::vector<double> times;
      for (const PersonResult& person : analysis.people) {
        if (person.withdrawn) continue;
        const ArmResult& arm = person.tasks[task].arms[i];
        trials += arm.trials;
        spoiled += arm.spoiled;
        for (const auto& [reason, count] : arm.reasons) reasons[reason] += count;
        if (arm.trials > 0 && study.tasks[task].two_intervals()) times.push_back(arm.response_time);
      }
      std::string causes;
      for (const auto& [reason, count] : reasons) {
        causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", escaped(reason), count);
      }
      const int all = trials + spoiled;
      rows.push_back({i == 0 ? escaped(study.tasks[task].name) : "",
                      escaped(arm_text(analysis.tasks[task], i)), std::to_string(trials),
                      std::to_string(spoiled), all > 0 ? percent(static_cast<double>(spoiled) / all, 1) : "-",
                      causes.empty() ? "-" : causes, times.empty() ? "-" : range_text(times, 2) + " s"});
    }
  }
  return rows;
}

}  // namespace

std::string unbroken(const std::string& text) {
  return "<span style=\"white-space:nowrap\">" + escaped(text) + "</span>";
}

void write_people_tables(Page& page, const Study& study, const StudyAnalysis& analysis, std::size_t task) {
  const StudyTask& of = study.tasks[task];
  if (!of.two_intervals()) {
    page.table(control_rows(analysis, task));
  } else if (of.signal) {
    page.table(sensitivity_rows(analysis, task));
  } else {
    page.table(function_rows(of, analysis, task));
  }
}

void write_flags(Page& page, const StudyAnalysis& analysis) {
  TableRows rows{{"person", "flags", "excluded from the main analysis", "left out of, with too few trials"}};
  std::size_t without = 0;
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    if (person.flags.empty() && person.exclusions.empty() && person.left_out.empty()) {
      ++without;
      continue;
    }
    std::string flags;
    for (const std::string& flag : person.flags) flags += (flags.empty() ? "" : "<br>") + escaped(flag);
    rows.push_back({escaped(person.id), flags.empty() ? "-" : flags,
                    person.exclusions.empty() ? "no" : escaped(joined(person.exclusions, "; ")),
                    person.left_out.empty() ? "-" : escaped(joined(person.left_out, "; "))});
  }
  if (rows.size() > 1) page.table(rows);
  page.paragraph(
      counted(without, "person has", "people have") +
      " no flag. A flag excludes nobody; only the rules that were fixed before do, and too few trials.");
}

void write_shares(Page& page, const Study& study, const StudyAnalysis& analysis) {
  if (!study.threshold_task()) return;
  page.section("shares", "Share of the noise threshold that was reached");
  page.paragraph(
      "The noise is set from the measurement of a person's threshold in the first session, or at the start "
      "of each one, which has an error. The best estimate uses all trials of the first session or of all, "
      "those of the repetition too. The shares below are those that were reached if this estimate is right, "
      "with 95 % intervals. \"range too small\": the threshold lies at the edge of the stimuli, and the "
      "noise of that session is no share of it.");
  TableRows rows{{"person"}};
  std::set<double> different;
  for (const study::TaskResult& task : analysis.tasks)
    different.insert(task.shares.begin(), task.shares.end());
  different.erase(0.0);
  const std::size_t setter = *study.threshold_task();
  std::set<int> sessions;
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    for (const study::SessionThreshold& one : person.tasks[setter].thresholds) sessions.insert(one.session);
  }
  for (const int session : sessions) rows[0].push_back(fmt::format("threshold, session {}", session));
  rows[0].emplace_back("reached / meant");
  for (const double share : different) rows[0].push_back("meant " + brief(share));
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    rows.push_back({escaped(person.id)});
    for (const int session : sessions) {
      const auto& all = person.tasks[setter].thresholds;
      const auto found =
          std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.session == session; });
      rows.back().push_back(found == all.end() ? "-"
                                               : unbroken(estimate_text(study.tasks[setter], found->fit)));
    }
    rows.back().push_back(person.reached ? factor_text(*person.reached) : "-");
    for (const double share : different) {
      rows.back().push_back(person.reached ? factor_text(*person.reached, share) : "-");
    }
  }
  page.table(rows);
}

void write_cues(Page& page, const Study& study, const StudyAnalysis& analysis) {
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    if (!study.tasks[task].comparison()) continue;
    TableRows rows{{"person", "peak force", "depth", "work"}};
    for (const PersonResult& person : analysis.people) {
      if (person.withdrawn || person.tasks[task].cues.empty()) continue;
      rows.push_back({escaped(person.id), "-", "-", "-"});
      for (const study::CueWeight& cue : person.tasks[task].cues) {
        const auto column = std::find(rows[0].begin(), rows[0].end(), cue.cue);
        const std::string text =
            fmt::format("{:+.2f} ({:+.2f} to {:+.2f})", cue.correlation, cue.low, cue.high);
        if (column != rows[0].end()) {
          rows.back()[static_cast<std::size_t>(column - rows[0].begin())] = text;
        }
      }
    }
    page.section("cues-" + std::to_string(task), "Cues in " + study.tasks[task].name);
    page.paragraph(
        "Correlation of the answer with the difference of a cue between the two presses, among trials of the "
        "same stiffness and order, with its 99 % interval. It is 0 for a person who answers by the stiffness "
        "alone. A person is flagged when the interval excludes 0.");
    if (rows.size() > 1) {
      page.table(rows);
    } else {
      page.paragraph("No cues were recorded.");
    }
  }
}

void write_blinding(Page& page, const StudyAnalysis& analysis) {
  page.section("blinding", "Blinding and audibility");
  page.paragraph(
      "After each block participant and experimenter guess whether its last trial had noise. Arms alternate "
      "within a block, so a guess is about one trial, and no index of blinding follows from it: compare the "
      "shares of yes after trials with and without noise. The blind analysis shows the guesses alone.");
  TableRows rows{{"who", "blocks", "yes", "no", "unsure", "confidence 1 to 5"}};
  for (const study::Guesses& guesses : analysis.guesses) {
    rows.push_back({escaped(guesses.who), blocks_of(guesses), std::to_string(guesses.yes),
                    std::to_string(guesses.no), std::to_string(guesses.unsure),
                    fixed(guesses.confidence, 1)});
  }
  if (rows.size() > 1) page.table(rows);
  if (rows.size() == 1) page.paragraph("Nobody was asked.");
  int checked = 0;
  int heard = 0;
  for (const PersonResult& person : analysis.people) {
    checked += person.audible ? 1 : 0;
    heard += person.heard ? 1 : 0;
  }
  page.paragraph(
      checked == 0
          ? std::string("The audibility check was not done.")
          : fmt::format("{} of {} people heard the noise with the hand off the device: 15 or more of "
                        "20 answers right, which chance gives in 2 % of the cases.",
                        heard, checked));
}

void write_quality(Page& page, const Study& study, const StudyAnalysis& analysis) {
  page.section("quality", "Spoiled trials, time and change");
  page.paragraph(
      "A spoiled trial is kept in the log and repeated. A share that differs between the conditions is a "
      "bias: the noise itself may have spoiled the trials.");
  page.table(spoiled_rows(study, analysis));
  int late = 0;
  int faults = 0;
  std::vector<double> minutes;
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    late += person.late_ticks;
    faults += person.faults;
    minutes.push_back(person.minutes);
  }
  page.facts({{"late ticks", std::to_string(late)},
              {"latched faults", std::to_string(faults)},
              {"time of all sessions: median (range)", range_text(minutes, 0) + " min"}});
  TableRows rows{{"task", "mean over the group, 0 without a change or a cue", "mean (95 %)", "p"}};
  for (const study::GroupChange& change : analysis.changes) {
    rows.push_back(
        {escaped(study.tasks[change.task].name), escaped(change.quantity),
         fmt::format("{:+.2f} ({:+.2f} to {:+.2f})", change.test.mean, change.test.low, change.test.high),
         escaped(study::p_text(change.test.two_sided))});
  }
  if (rows.size() > 1) page.table(rows);
}

void write_limits(Page& page, const Study& study, const StudyAnalysis& analysis, bool simulated) {
  page.section("limits", "Limits of this study");
  std::vector<std::string> limits = {
      "No statement about a single person is possible: with 40 trials a level most real effects of one "
      "person are not significant.",
      "An interval that contains no effect is not evidence of no effect. Read the interval and the smallest "
      "effect that the study finds.",
      "The share of the noise threshold is of the commanded noise. Friction and inertia of the device filter "
      "it, so shares compare within one device.",
      "People who tire, learn or adapt make all intervals too short: compare the halves and the changes.",
      "All contrasts but the primary one are exploratory.",
      "The simulator is no medical device. A gain in it is not a gain at patients."};
  if (simulated)
    limits.insert(limits.begin(), "All participants are simulated: this is no result about people.");
  page.list(limits);
  page.section("falsification", "Results that would contradict the hypothesis");
  std::vector<std::string> against;
  if (analysis.unblinded && study.primary) {
    const study::PrimaryAnalysis& primary = *study.primary;
    against.push_back(fmt::format(
        "Primary: the interval of {} - {} in {} lies wholly on the side {}. An interval on both sides "
        "decides nothing.",
        primary.condition, primary.reference, primary.task,
        primary.alternative == "two-sided" ? "where the noise harms"
                                           : "opposite to the alternative (" + primary.alternative + ")"));
  }
  against.insert(against.end(),
                 {"Noise near the tissue alone helps and constant noise does not: then the noise is a cue of "
                  "distance, and stochastic resonance is not shown.",
                  "The curve does not fall again at strong noise: then it is not the inverted U of "
                  "stochastic resonance.",
                  "People say yes more often after trials with noise, or hear it: then expectation may "
                  "explain the difference.",
                  "Spoiled trials or response times differ between the conditions as the effect does.",
                  "The effect vanishes with the excluded people, or comes from them alone."});
  page.list(against);
}

}  // namespace palpate::report
