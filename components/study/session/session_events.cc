#include "study/session/session_events.h"

#include <cmath>

#include "core/base/text.h"

namespace palpate::study {

EventRecord event_of(const std::string& name, std::vector<std::pair<std::string, std::string>> values) {
  EventRecord event;
  event.time = utc_now();
  event.event = name;
  event.values = std::move(values);
  return event;
}

std::optional<EventRecord> practice_event(const Study& study, const Course& course, const TrialRecord& last) {
  if (!last.practice) return std::nullopt;
  const StudyTask& task = study.tasks[study.find_task(last.task).value()];
  const std::optional<Trial> next = course.next();
  if (!course.training_ended() || !next) return std::nullopt;  // not after the refresher of an interruption
  const Course::Practice practice = course.practice();
  return event_of("practice", {{"session", std::to_string(last.session)},
                               {"task", task.name},
                               {"trials", std::to_string(practice.trials)},
                               {"correct", std::to_string(practice.correct)},
                               {"of", std::to_string(task.practice_until->of)},
                               {"met", practice.met ? "yes" : "no"}});
}

EventRecord threshold_event(int session, const Course::Threshold& threshold, const std::string& decision) {
  const auto newton = [](double log10) { return brief(std::pow(10.0, log10)); };
  std::vector<std::pair<std::string, std::string>> values = {
      {"session", std::to_string(session)},
      {"measured_in", std::to_string(threshold.session)},
      {"sd_N", newton(threshold.log10.mean)},
      {"low_N", newton(threshold.log10.low)},
      {"high_N", newton(threshold.log10.high)},
      {"edge", !threshold.at_edge ? "no"
               : threshold.above  ? "largest"
                                  : "least"}};
  if (!decision.empty()) values.emplace_back("decision", decision);
  return event_of("threshold", std::move(values));
}

}  // namespace palpate::study
