#include <nlohmann/json.hpp>

#include "study/session/analysis_text.h"

namespace palpate::study {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const psychophysics::Estimate& estimate) {
  return {{"mean", estimate.mean}, {"sd", estimate.sd}, {"low", estimate.low}, {"high", estimate.high}};
}

Json json_of(const psychophysics::PairedTest& test) {
  return {{"mean", test.mean},
          {"low", test.low},
          {"high", test.high},
          {"p_two_sided", test.two_sided},
          {"p_greater", test.greater}};
}

// Counts by arm are shown after unblinding alone.
Json json_of(const Missing& missing, bool unblinded) {
  Json json = {{"people", missing.people},
               {"lowest_effect", missing.low},
               {"highest_effect", missing.high},
               {"thresholds_at_the_edge", missing.outside_condition + missing.outside_reference}};
  if (!unblinded) return json;
  json.update({{"in_condition", missing.in_condition},
               {"in_reference", missing.in_reference},
               {"at_the_edge_in_condition", missing.outside_condition},
               {"at_the_edge_in_reference", missing.outside_reference}});
  return json;
}

Json json_of(const std::optional<Effect>& effect, bool unblinded) {
  if (!effect) return nullptr;
  return {{"people", effect->people},
          {"effect", effect->effect},
          {"low", effect->low},
          {"high", effect->high},
          {"p_value", effect->p_value},
          {"interval_is_wider", effect->open},
          {"smallest_effect", effect->open ? Json(nullptr) : Json(effect->smallest_effect)},
          {"left_out", json_of(effect->missing, unblinded)}};
}

Json json_of(const StudyTask& task, const std::optional<ThresholdFit>& fit) {
  if (!fit) return nullptr;
  Json json = {{"trials", fit->trials}, {"range_too_small", fit->range_too_small}};
  if (fit->range_too_small) return json;
  const Readable value = readable_estimate(task, fit->estimate.mean);
  json.update({{"value", value.value},
               {"low", readable_estimate(task, fit->estimate.low).value},
               {"high", readable_estimate(task, fit->estimate.high).value},
               {"unit", value.unit},
               {"log10", json_of(fit->estimate)},
               {"location", fit->function.location},
               {"spread", fit->function.spread},
               {"lapse", fit->function.lapse}});
  return json;
}

Json json_of(const StudyTask& task, const std::string& name, const ArmResult& arm) {
  Json json = {
      {"condition", name}, {"trials", arm.trials}, {"spoiled", arm.spoiled}, {"reasons", arm.reasons}};
  if (!task.two_intervals()) {
    if (arm.ln_rms) json["ln_rms"] = *arm.ln_rms;
    if (arm.ln_variation) json["ln_variation"] = *arm.ln_variation;
    return json;
  }
  json["response_time_s"] = arm.response_time;
  json["points"] = Json::array();
  for (const Point& point : arm.points) {
    const Readable level = readable_level(task, point.level);
    json["points"].push_back({{"level", point.level},
                              {"stimulus", level.value},
                              {"unit", level.unit},
                              {"trials", point.count.trials},
                              {"counted", point.count.counted}});
  }
  json["estimate"] = json_of(task, arm.fit);
  json["first_half"] = json_of(task, arm.first_half);
  json["second_half"] = json_of(task, arm.second_half);
  json["repeated"] = json_of(task, arm.repeated);
  if (arm.sensitivity) {
    json["d_prime"] = arm.sensitivity->d_prime;
    json["criterion"] = arm.sensitivity->criterion;
  }
  return json;
}

Json json_of(const Study& study, const StudyAnalysis& analysis, const PersonResult& person) {
  Json json = {{"id", person.id}, {"withdrawn", person.withdrawn}};
  if (person.withdrawn) return json;
  json.update({{"observer", person.observer},
               {"trials", person.trials},
               {"spoiled", person.spoiled},
               {"minutes", person.minutes},
               {"late_ticks", person.late_ticks},
               {"faults", person.faults},
               {"catch_trials", person.catch_trials.trials},
               {"catch_correct", person.catch_trials.counted},
               {"lapses_often", person.lapses_often},
               {"flags", person.flags},
               {"exclusions", person.exclusions},
               {"left_out", person.left_out}});
  if (person.audible)
    json["audible"] = {{"trials", person.audible->trials}, {"correct", person.audible->counted}};
  if (person.reached) json["log10_share_reached"] = json_of(*person.reached);
  json["tasks"] = Json::array();
  for (std::size_t i = 0; i < person.tasks.size(); ++i) {
    const PersonTask& of = person.tasks[i];
    Json task = {{"task", study.tasks[i].name}};
    for (std::size_t arm = 0; analysis.shows_people(i) && arm < of.arms.size(); ++arm) {
      task["conditions"].push_back(json_of(study.tasks[i], analysis.tasks[i].arms[arm], of.arms[arm]));
    }
    for (const CueWeight& cue : of.cues) {
      task["cues"].push_back(
          {{"cue", cue.cue}, {"correlation", cue.correlation}, {"low", cue.low}, {"high", cue.high}});
    }
    for (const SessionThreshold& one : of.thresholds) {
      Json threshold = json_of(study.tasks[i], std::optional<ThresholdFit>(one.fit));
      threshold["session"] = one.session;
      task["thresholds"].push_back(std::move(threshold));
    }
    if (of.trend) task["trend"] = {{"log_odds", of.trend->change}, {"z", of.trend->z}};
    json["tasks"].push_back(task);
  }
  return json;
}

Json contrasts_json(const Study& study, const StudyAnalysis& analysis) {
  Json all = Json::array();
  for (const Contrast& contrast : analysis.contrasts) {
    Json json = {{"task", study.tasks[contrast.task].name},
                 {"contrast", contrast_name(analysis, contrast)},
                 {"measure", contrast.measure},
                 {"alternative", contrast.alternative},
                 {"primary", contrast.primary},
                 {"main_analysis", json_of(contrast.kept, analysis.unblinded)},
                 {"with_excluded_people", json_of(contrast.everybody, analysis.unblinded)}};
    json["p_holm"] = contrast.holm ? Json(*contrast.holm) : Json(nullptr);
    all.push_back(json);
  }
  return all;
}

Json curves_json(const Study& study, const StudyAnalysis& analysis) {
  Json all = Json::array();
  for (const Curve& curve : analysis.curves) {
    Json json = {{"task", study.tasks[curve.task].name}, {"people", curve.d_primes.size()}};
    for (std::size_t i = 0; i < curve.levels.size(); ++i) {
      Json level = json_of(curve.levels[i]);
      level.erase("p_two_sided");
      level.erase("p_greater");
      level["condition"] = analysis.tasks[curve.task].arms[i];
      json["d_prime"].push_back(level);
    }
    if (curve.inverted_u) {
      json["inverted_u"] = {{"rise", json_of(curve.inverted_u->rise)},
                            {"fall", json_of(curve.inverted_u->fall)},
                            {"found", curve.found}};
    }
    all.push_back(json);
  }
  return all;
}

Json deletions_json(const Deletions& deletions) {
  Json json = Json::array();
  for (const auto& [id, deletion] : deletions) {
    json.push_back({{"id", id}, {"time", deletion.time}, {"reason", deletion.reason}});
  }
  return json;
}

}  // namespace

std::string analysis_json(const Study& study, const StudyAnalysis& analysis) {
  Json json = {{"study", study.name},
               {"unblinded", analysis.unblinded},
               {"consented", analysis.consented},
               {"refused", analysis.refused},
               {"withdrawn", analysis.withdrawn},
               {"excluded", analysis.excluded},
               {"deleted", deletions_json(analysis.deleted)},
               {"contrasts", contrasts_json(study, analysis)},
               {"curves", curves_json(study, analysis)}};
  if (analysis.own_level) json["own_level"] = json_of(analysis.own_level, true);
  json["changes"] = Json::array();
  for (const GroupChange& change : analysis.changes) {
    json["changes"].push_back({{"task", study.tasks[change.task].name},
                               {"quantity", change.quantity},
                               {"test", json_of(change.test)}});
  }
  json["blinding"] = Json::array();
  for (const Guesses& guesses : analysis.guesses) {
    Json one = {{"who", guesses.who},
                {"yes", guesses.yes},
                {"no", guesses.no},
                {"unsure", guesses.unsure},
                {"confidence", guesses.confidence}};
    if (!guesses.pooled) one["noise"] = guesses.noise;
    json["blinding"].push_back(one);
  }
  json["people"] = Json::array();
  for (const PersonResult& person : analysis.people)
    json["people"].push_back(json_of(study, analysis, person));
  return json.dump(2) + '\n';
}

}  // namespace palpate::study
