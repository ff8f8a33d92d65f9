#include "study/session/analysis_text.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/core.h>

#include "core/base/text.h"

#include "study/session/deletion.h"

namespace palpate::study {
namespace {

std::string contrast_line(const Study& study, const StudyAnalysis& analysis, const Contrast& contrast) {
  std::string line = fmt::format("  {}, {}, {}: ", study.tasks[contrast.task].name,
                                 contrast_name(analysis, contrast), measure_name(contrast.measure));
  if (!contrast.kept) return line + "fewer than two people with 10 trials in both conditions\n";
  line += effect_text(contrast, *contrast.kept);
  if (contrast.holm) line += ", Holm " + p_text(*contrast.holm);
  if (const std::string missing = missing_text(analysis, contrast, *contrast.kept); !missing.empty()) {
    line += "\n    " + missing;
  }
  if (contrast.everybody && contrast.everybody->people != contrast.kept->people) {
    line += "\n    with excluded people: " + effect_text(contrast, *contrast.everybody);
  }
  if (contrast.primary) line += "\n    " + smallest_effect_text(contrast, *contrast.kept);
  return line + '\n';
}

std::string contrasts_text(const Study& study, const StudyAnalysis& analysis) {
  std::string text;
  bool exploratory = false;
  for (const Contrast& contrast : analysis.contrasts) {
    if (contrast.primary) text += "Primary analysis\n";
    if (!contrast.primary && !exploratory) {
      text += analysis.unblinded ? "Exploratory, p values adjusted by Holm within each task\n"
                                 : "All pairs, without names until the study is unblinded\n";
      exploratory = true;
    }
    text += contrast_line(study, analysis, contrast);
  }
  return text;
}

std::string curves_text(const Study& study, const StudyAnalysis& analysis) {
  std::string text;
  for (const Curve& curve : analysis.curves) {
    text +=
        fmt::format("Sensitivity in {}, {} people\n", study.tasks[curve.task].name, curve.d_primes.size());
    for (std::size_t i = 0; i < curve.levels.size(); ++i) {
      const psychophysics::PairedTest& level = curve.levels[i];
      text += fmt::format("  {:<6} d' {:.2f} ({:.2f} to {:.2f})\n", analysis.tasks[curve.task].arms[i],
                          level.mean, level.low, level.high);
    }
    if (curve.inverted_u) text += "  " + inverted_u_text(curve) + '\n';
  }
  return text;
}

std::string people_text(const StudyAnalysis& analysis) {
  std::string text;
  for (const PersonResult& person : analysis.people) {
    if (person.withdrawn) continue;
    text += fmt::format("  {}: {}{}\n", person.id,
                        counted(static_cast<std::uint64_t>(person.trials), "trial", "trials"),
                        person.spoiled > 0 ? fmt::format(", {} spoiled", person.spoiled) : "");
    for (const std::string& flag : person.flags) text += "    " + flag + '\n';
    for (const std::string& reason : person.exclusions) text += "    excluded: " + reason + '\n';
    for (const std::string& where : person.left_out) text += "    left out of " + where + '\n';
  }
  return text.empty() ? "" : "People\n" + text;
}

}  // namespace

std::string p_text(double p_value) {
  return p_value < 0.001 ? "p < 0.001" : fmt::format("p = {:.3f}", p_value);
}

std::string contrast_name(const StudyAnalysis& analysis, const Contrast& contrast) {
  const std::vector<std::string>& arms = analysis.tasks[contrast.task].arms;
  return arms[contrast.condition] + (analysis.unblinded ? " - " : " against ") + arms[contrast.reference];
}

std::string measure_name(const std::string& measure) {
  if (measure == "ln_jnd") return "JND";
  if (measure == "ln_threshold") return "threshold";
  if (measure == "ln_rms") return "RMS error";
  if (measure == "ln_variation") return "coefficient of variation";
  return "d'";
}

bool is_ratio(const std::string& measure) { return measure.starts_with("ln_"); }

std::string effect_value(const std::string& measure, double effect) {
  return is_ratio(measure) ? fmt::format("x {:.2f}", std::exp(effect)) : fmt::format("{:+.2f}", effect);
}

std::string interval_text(const std::string& measure, const Effect& effect) {
  const std::size_t unit = is_ratio(measure) ? 2 : 0;  // without "x "
  return effect_value(measure, effect.low).substr(unit) + " to " +
         effect_value(measure, effect.high).substr(unit) + (effect.open ? " or wider" : "");
}

std::string effect_text(const Contrast& contrast, const Effect& effect) {
  const std::string side =
      contrast.alternative == "two-sided" ? "" : " (one-sided, " + contrast.alternative + ")";
  return fmt::format("{} (95 % {}), {}, {}{}", effect_value(contrast.measure, effect.effect),
                     interval_text(contrast.measure, effect),
                     counted(static_cast<std::size_t>(effect.people), "person", "people"),
                     p_text(effect.p_value), side);
}

std::string missing_text(const StudyAnalysis& analysis, const Contrast& contrast, const Effect& effect) {
  const Missing& missing = effect.missing;
  const std::vector<std::string>& arms = analysis.tasks[contrast.task].arms;
  const auto by_arm = [&](int condition, int reference) {
    return analysis.unblinded ? fmt::format(" ({} {}, {} {})", arms[contrast.condition], condition,
                                            arms[contrast.reference], reference)
                              : std::string();
  };
  std::string text;
  if (missing.people > 0) {
    text = fmt::format("left out with too few trials: {}{}; worst case {} to {}",
                       counted(static_cast<std::size_t>(missing.people), "person", "people"),
                       by_arm(missing.in_condition, missing.in_reference),
                       effect_value(contrast.measure, missing.low),
                       effect_value(contrast.measure, missing.high));
  }
  const int outside = missing.outside_condition + missing.outside_reference;
  if (outside == 0) return text;
  return text + fmt::format("{}thresholds at the edge of the stimuli: {}{}; their answers count",
                            text.empty() ? "" : "; ", outside,
                            by_arm(missing.outside_condition, missing.outside_reference));
}

std::string smallest_effect_text(const Contrast& contrast, const Effect& effect) {
  if (effect.open) return "too few trials or people to state the smallest effect that this study finds";
  std::string sizes;
  if (contrast.alternative != "greater") sizes = effect_value(contrast.measure, -effect.smallest_effect);
  if (contrast.alternative != "less") {
    sizes += (sizes.empty() ? "" : " or ") + effect_value(contrast.measure, effect.smallest_effect);
  }
  return "smallest effect that this study finds with power 0.8: " + sizes;
}

std::string estimate_text(const StudyTask& task, const std::optional<ThresholdFit>& fit) {
  if (!fit) return "no trials";
  if (fit->range_too_small) return "range too small";
  const Readable middle = readable_estimate(task, fit->estimate.mean);
  const bool ratio = std::string_view(middle.unit) == "ratio";
  return fmt::format("{}{} ({} to {}){}", ratio ? "x " : "", brief(middle.value, 3),
                     brief(readable_estimate(task, fit->estimate.low).value, 3),
                     brief(readable_estimate(task, fit->estimate.high).value, 3),
                     ratio ? "" : std::string(" ") + middle.unit);
}

std::string inverted_u_text(const Curve& curve) {
  const psychophysics::InvertedU& shape = *curve.inverted_u;
  return fmt::format(
      "middle less first level {:+.2f}, one-sided {}; last less middle {:+.2f}, one-sided {}: {}",
      shape.rise.mean, p_text(shape.rise.greater), -shape.fall.mean, p_text(shape.fall.greater),
      curve.found ? "an inverted U is found" : "no inverted U is shown");
}

std::string own_level_text(const Study& study, const Effect& effect) {
  Contrast contrast;
  contrast.measure = "d_prime";
  return fmt::format(
      "Own level in {}, chosen in one half of the trials and judged in the other, less no noise: {}",
      study.own_level, effect_text(contrast, effect));
}

const char* blocks_of(const Guesses& guesses) {
  if (guesses.pooled) return "all blocks";
  return guesses.noise ? "last trial with noise" : "last trial without noise";
}

std::string analysis_text(const Study& study, const StudyAnalysis& analysis) {
  const bool simulated = std::any_of(analysis.people.begin(), analysis.people.end(),
                                     [](const PersonResult& person) { return !person.observer.empty(); });
  std::string text =
      fmt::format("{}: {}{}\n{}, {} withdrawn, {} excluded from the main analysis\n", study.name,
                  analysis.unblinded ? "UNBLINDED" : "BLIND (conditions are A, B, C)",
                  simulated ? ", SIMULATED: no result about people" : "",
                  counted(analysis.people.size(), "person", "people"), analysis.withdrawn, analysis.excluded);
  if (!analysis.deleted.empty()) text += deletions_text(analysis.deleted) + '\n';
  text += contrasts_text(study, analysis) + curves_text(study, analysis);
  if (analysis.own_level) text += own_level_text(study, *analysis.own_level) + '\n';
  for (const GroupChange& change : analysis.changes) {
    text += fmt::format("Group mean in {}, {}: {:+.2f} ({:+.2f} to {:+.2f})\n", study.tasks[change.task].name,
                        change.quantity, change.test.mean, change.test.low, change.test.high);
  }
  for (const Guesses& guesses : analysis.guesses) {
    text += fmt::format("Blinding, {}, {}: {} yes, {} no, {} unsure, confidence {:.1f}\n", guesses.who,
                        blocks_of(guesses), guesses.yes, guesses.no, guesses.unsure, guesses.confidence);
  }
  return text + people_text(analysis);
}

}  // namespace palpate::study
