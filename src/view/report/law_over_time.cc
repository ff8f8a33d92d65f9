#include "view/report/law_over_time.h"

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/analysis.h"
#include "view/report/text_format.h"

namespace palpate::report {
namespace {

std::string noise_text(const haptics::LiveNoise& noise) {
  if (!noise.enabled) return "touch noise off";
  return fmt::format("touch noise on, K {} N m, d\u2080 {} mm", shortest(noise.gain),
                     shortest(noise.threshold / kMillimetre));
}

std::string tissue_text(const model::TissueParameters& tissue) {
  std::string text =
      fmt::format("tissue {}, {}: k1 {} N/m, beta {}, q {}", tissue.name, model::to_string(tissue.law),
                  shortest(tissue.k1), shortest(tissue.beta), shortest(tissue.q));
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    text += fmt::format(", relaxing by {} in {} s", shortest(term.g), shortest(term.tau));
  }
  return text;
}

}  // namespace

LawOverTime::LawOverTime(const record::Recording& recording, model::Direction direction)
    : recording_(recording),
      direction_(direction),
      period_(1.0 / recording.setup.rate_Hz),
      law_(law_of(recording.setup, direction)),
      relaxation_(recording.setup.tissue.relaxation, period_) {}

void LawOverTime::change_to(const model::TissueParameters& tissue) {
  const model::Relaxation before = relaxation_;
  law_ = model::SpringLaw(tissue, direction_, period_);
  relaxation_ = model::Relaxation(tissue.relaxation, period_);
  relaxation_.convert_history(memory_, before);
}

double LawOverTime::force_at(const haptics::TickRow& row) {
  const std::vector<haptics::ParameterUpdate>& changes = recording_.changes;
  for (; next_change_ < changes.size() && changes[next_change_].tick <= row.tick; ++next_change_) {
    const haptics::ParameterUpdate& change = changes[next_change_];
    if ((change.what & haptics::kTissueChanged) != 0) change_to(tissue_of(change));
  }
  if (!in_contact(row, direction_)) {
    memory_ = {};
    return 0.0;
  }
  return relaxation_.next(memory_, law_.force_at(row.depth).force);
}

namespace {

std::string change_text(const haptics::ParameterUpdate& change) {
  if ((change.what & haptics::kTissueChanged) != 0) return tissue_text(tissue_of(change));
  if ((change.what & haptics::kNoiseChanged) != 0) return noise_text(change.noise);
  if ((change.what & haptics::kStimulusChanged) != 0) {
    return fmt::format("commanded force {} N within {} ms", shortest(change.stimulus.force),
                       brief(1e3 * change.stimulus.ramp, 3));
  }
  const haptics::LiveInclusion& inclusion = change.inclusion;
  return fmt::format("inclusion {} at {} with stiffness ratio {}", inclusion.index + 1,
                     point_mm({inclusion.centre_S[0], inclusion.centre_S[1], inclusion.centre_S[2]}),
                     brief(inclusion.ratio, 3));
}

}  // namespace

std::vector<std::string> changes_text(const record::Recording& recording) {
  constexpr std::size_t kMostTold = 20;
  std::vector<std::string> words;
  for (const haptics::ParameterUpdate& change : recording.changes) {
    if (words.size() == kMostTold) {
      words.push_back(fmt::format("and {} more changes while it ran", recording.changes.size() - kMostTold));
      break;
    }
    const double time = static_cast<double>(change.tick) / recording.setup.rate_Hz;
    words.push_back(fmt::format("changed while it ran, from tick {} ({} s) on: {}", change.tick,
                                fixed(time, 3), change_text(change)));
  }
  return words;
}

}  // namespace palpate::report
