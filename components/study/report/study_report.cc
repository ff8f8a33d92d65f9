#include "study/report/study_report.h"

#include <cctype>
#include <cstdint>
#include <optional>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/input_file.h"
#include "palpate/version.h"
#include "view/report/page.h"

#include "study/report/study_report_sections.h"
#include "study/session/analysis_text.h"
#include "study/session/deletion.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;
using study::Contrast;
using study::Study;
using study::StudyAnalysis;
using study::StudyFolder;

constexpr InputKind kTextInput{"a text file of the study", std::uint64_t{1} << 20};

std::string content_of(const fs::path& file) { return InputFile(file, kTextInput).read_rest(); }

std::string bold(const std::string& text) { return "<strong>" + escaped(text) + "</strong>"; }

// The blind mark, or the primary result.
void write_result(Page& page, const StudyFolder& study, const StudyAnalysis& analysis) {
  page.section("result", "Result");
  if (study.simulated) {
    page.paragraph(bold("SIMULATED.") +
                   " All participants are simulated observers. This is no result about people.");
  }
  if (!analysis.unblinded) {
    page.paragraph(bold("BLIND.") +
                   " Conditions are called A, B, C, the same for all people; nobody has seen which is which. "
                   "The primary contrast and the shape of the curve are shown after <code>palpate study "
                   "unblind</code>.");
    return;
  }
  page.paragraph(bold("UNBLINDED.") + " " +
                 escaped(study.unblinding->time + ": " + study.unblinding->reason));
  for (const Contrast& contrast : analysis.contrasts) {
    if (!contrast.primary) continue;
    page.paragraph(
        "Primary analysis, " +
        bold(fmt::format("{}: {} of {}", study.study.tasks[contrast.task].name,
                         study::measure_name(contrast.measure), contrast_name(analysis, contrast))) +
        ": " + (contrast.kept ? escaped(effect_text(contrast, *contrast.kept)) : "too few people") + ".");
    if (!contrast.kept) continue;
    std::string smallest = smallest_effect_text(contrast, *contrast.kept);
    smallest.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(smallest.front())));
    page.paragraph(escaped(smallest) +
                   (contrast.kept->open ? "." : ". It follows from the width of the interval."));
    const std::string missing = missing_text(analysis, contrast, *contrast.kept);
    if (!missing.empty()) page.paragraph("In this contrast, " + escaped(missing) + ".");
  }
  for (const study::Curve& curve : analysis.curves) {
    if (!curve.inverted_u) continue;
    page.paragraph("Inverted U in " + bold(study.study.tasks[curve.task].name) + ": " +
                   escaped(inverted_u_text(curve)) + ".");
  }
}

void write_who(Page& page, const StudyFolder& study, const StudyAnalysis& analysis) {
  page.section("people", "People");
  const Study& of = study.study;
  page.facts({{"prepared for", counted(study.ids.size(), "person", "people")},
              {"took part", counted(analysis.people.size(), "person", "people")},
              {"consented, refused", analysis.consented + analysis.refused == 0
                                         ? "nobody was asked"
                                         : fmt::format("{}, {}", analysis.consented, analysis.refused)},
              {"withdrew and are left out", std::to_string(analysis.withdrawn)},
              {"data deleted", analysis.deleted.empty() ? "nobody's" : deletions_text(analysis.deleted)},
              {"excluded from the main analysis", std::to_string(analysis.excluded)},
              {"rules of exclusion, fixed before", joined(study::exclusion_rules(of), ", or ")},
              {"approval", of.approval.empty() ? "none stated" : of.approval}});
  page.heading("Flags and exclusions");
  write_flags(page, analysis);
}

// An effect with its interval.
std::string short_effect(const Contrast& contrast, const std::optional<study::Effect>& effect) {
  if (!effect) return "too few people";
  return unbroken(fmt::format("{} ({})", study::effect_value(contrast.measure, effect->effect),
                              interval_text(contrast.measure, *effect)));
}

// A p value for a column of them: "0.021" or "< 0.001".
std::string p_value_of(double p_value) {
  const std::string text = study::p_text(p_value).substr(2);
  return unbroken(text.starts_with("= ") ? text.substr(2) : text);
}

TableRows effect_rows(const Study& study, const StudyAnalysis& analysis) {
  TableRows rows{
      {"task", "measure", "conditions", "effect (95 %)", "people", "p", "p by Holm", "with excluded people"}};
  for (const Contrast& contrast : analysis.contrasts) {
    const bool same =
        contrast.kept && contrast.everybody && contrast.kept->people == contrast.everybody->people;
    rows.push_back({escaped(study.tasks[contrast.task].name) + (contrast.primary ? " (primary)" : ""),
                    escaped(study::measure_name(contrast.measure)),
                    unbroken(contrast_name(analysis, contrast)), short_effect(contrast, contrast.kept),
                    contrast.kept ? std::to_string(contrast.kept->people) : "-",
                    contrast.kept ? p_value_of(contrast.kept->p_value) : "-",
                    contrast.holm ? p_value_of(*contrast.holm) : "-",
                    same ? "same" : short_effect(contrast, contrast.everybody)});
  }
  return rows;
}

// Who is left out of each contrast, and by which arm.
void write_missing(Page& page, const Study& study, const StudyAnalysis& analysis) {
  TableRows rows{{"task", "conditions", "left out, and thresholds at the edge of the stimuli"}};
  for (const Contrast& contrast : analysis.contrasts) {
    if (!contrast.kept) continue;
    const std::string missing = missing_text(analysis, contrast, *contrast.kept);
    if (missing.empty()) continue;
    rows.push_back({escaped(study.tasks[contrast.task].name), unbroken(contrast_name(analysis, contrast)),
                    escaped(missing)});
  }
  if (rows.size() == 1) return;
  page.table(rows);
  page.paragraph(
      "Worst case: the mean effect if all who are left out had the lowest or the highest effect, of a JND or "
      "threshold a factor of 4.5, else that of the others.");
}

void write_effects(Page& page, const Study& study, const StudyAnalysis& analysis, const fs::path& folder) {
  page.section("effects", "Effects in the group");
  if (analysis.contrasts.empty()) {
    page.paragraph("Fewer than two people have answers in two conditions of a task.");
    return;
  }
  page.paragraph(
      "JND and thresholds: hierarchical likelihood of all people's answers; the JND is measured as a "
      "logarithm of the stiffness ratio. A person whose threshold lies outside the stimuli is not left out: "
      "the answers say that it is at least, or at most, so large. d' and force control: paired t test of the "
      "people's values. Exploratory p values are adjusted by Holm within each task.");
  bool ratios = false;
  bool differences = false;
  for (const Contrast& contrast : analysis.contrasts) {
    if (contrast.kept) (study::is_ratio(contrast.measure) ? ratios : differences) = true;
  }
  std::vector<Figure> figures;
  if (ratios) figures.push_back(draw_effects(study, analysis, true, folder / "effects.svg"));
  if (differences) figures.push_back(draw_effects(study, analysis, false, folder / "differences.svg"));
  page.figures("one", figures);
  page.table(effect_rows(study, analysis));
  write_missing(page, study, analysis);
}

void write_curves(Page& page, const Study& study, const StudyAnalysis& analysis, const fs::path& folder) {
  for (const study::Curve& curve : analysis.curves) {
    const std::string& name = study.tasks[curve.task].name;
    page.section("curve-" + std::to_string(curve.task), "Sensitivity against the noise: " + name);
    page.figures("one",
                 {draw_curve(study, analysis, curve, folder / fmt::format("curve-{}.svg", curve.task))});
    TableRows rows{{"condition", "d', mean (95 %)"}};
    for (std::size_t arm = 0; arm < curve.levels.size(); ++arm) {
      rows.push_back({escaped(arm_text(analysis.tasks[curve.task], arm)),
                      fmt::format("{:.2f} ({:.2f} to {:.2f})", curve.levels[arm].mean, curve.levels[arm].low,
                                  curve.levels[arm].high)});
    }
    page.table(rows);
    page.paragraph(curve.inverted_u ? escaped(inverted_u_text(curve)) + ". Both one-sided tests must reject."
                                    : "The two one-sided tests of an inverted U are shown after unblinding.");
  }
}

void write_own_level(Page& page, const Study& study, const StudyAnalysis& analysis) {
  if (!analysis.own_level) return;
  page.section("own-level", "Own level of the noise");
  page.paragraph(
      escaped(study::own_level_text(study, *analysis.own_level)) +
      ". A level that was chosen and judged in the same trials would seem to help without any effect.");
}

void write_tasks(Page& page, const Study& study, const StudyAnalysis& analysis, const fs::path& folder) {
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    page.section("task-" + std::to_string(task), "Each person: " + study.tasks[task].name);
    if (!analysis.shows_people(task)) {
      page.paragraph(
          "Shown after unblinding: beside the log, the results of one person would reveal the labels.");
      continue;
    }
    if (study.tasks[task].two_intervals() && !study.tasks[task].signal) {
      page.figures("", {draw_people(study, analysis, task, folder / fmt::format("people-{}.svg", task))});
      page.paragraph(
          "Estimates with 95 % intervals of the posterior. Halves: the first and the second half of the "
          "trials. Bias c: above 0 for more answers \"second interval\". A threshold at the edge of the "
          "stimuli is no number: \"range too small\".");
    }
    write_people_tables(page, study, analysis, task);
  }
}

void write_registration(Page& page, const StudyFolder& study, const StudyAnalysis& analysis,
                        const std::filesystem::path& folder, const std::string& command) {
  page.section("registration", "Registration and seeds");
  page.facts({{"SHA-256 of lock.json", study.lock_hash},
              {"scene", study.study.scene},
              {"seed of stimuli and orders", std::to_string(study.study.seed)},
              {"palpate", kVersion}});
  if (const auto& calibration = study.study.calibration) {
    page.paragraph(
        fmt::format("Calibration {} (SHA-256 {}): {}. So the largest noise of the study, {} N, is {} {}.",
                    study.study.calibration_file, calibration->sha256, describe(*calibration),
                    shortest(study.study.max_noise), brief(calibration->at_grip(study.study.max_noise), 3),
                    calibration->unit));
    page.figures("one", {draw_calibration(*calibration, folder / "calibration.svg")});
  } else {
    page.paragraph("No calibration: how much of the commanded noise reached the grip is not known.");
  }
  const std::string sound = study::sound_text(study.study);
  page.paragraph(sound.empty() ? "How loud mask and motors are at the ears was not measured."
                               : "Sound: " + escaped(sound) + ".");
  page.code(command);
  if (!analysis.unblinded) {
    page.paragraph(
        "The registered study file is study.toml in the folder of the study; lock.json holds its hash. Its "
        "text is printed here after unblinding.");
    return;
  }
  page.paragraph("The study as it was registered before the first participant:");
  page.code(content_of(study.folder / "study.toml"));
}

}  // namespace

fs::path write_study_report(const StudyFolder& study, const StudyAnalysis& analysis, const fs::path& folder,
                            const std::string& command) {
  make_report_folder(folder);
  const Study& of = study.study;
  Page page("Study: " + of.name, fmt::format("{}{}", analysis.unblinded ? "unblinded" : "blind",
                                             study.simulated ? ", simulated participants" : ""));
  write_result(page, study, analysis);
  write_who(page, study, analysis);
  write_effects(page, of, analysis, folder);
  write_curves(page, of, analysis, folder);
  write_own_level(page, of, analysis);
  write_tasks(page, of, analysis, folder);
  write_shares(page, of, analysis);
  write_cues(page, of, analysis);
  write_blinding(page, analysis);
  write_quality(page, of, analysis);
  write_limits(page, of, analysis, study.simulated);
  write_registration(page, study, analysis, folder, command);
  return page.write(folder);
}

}  // namespace palpate::report
