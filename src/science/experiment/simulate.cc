#include "science/experiment/simulate.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "science/experiment/course.h"
#include "science/experiment/simulated_person.h"

namespace palpate::experiment {
namespace {

int planned_trials(const PlannedSession& session) {
  int trials = 0;
  for (const PlannedPart& part : session.parts) trials += part.trials;
  return trials;
}

EventRecord event_of(const std::string& name, std::vector<std::pair<std::string, std::string>> values) {
  EventRecord event;
  event.time = utc_now();
  event.event = name;
  event.values = std::move(values);
  return event;
}

}  // namespace

void simulate_participant(const StudyFolder& study, SealedKey key, const std::string& id,
                          const std::string& observer) {
  const std::uint32_t number = study.number_of(id);
  SimulatedPerson person = make_person(observer, study.study.seed, number);
  LogWriter log(study.log_of(id), study.lock_hash, LogWriter::Sync::kAtEnd);
  if (!log.opened().trials.empty()) {
    throw InputError(study.log_of(id).string() + ": has trials already, simulate only fills empty logs");
  }
  Course course(study.study, key, number);
  const std::vector<PlannedSession> plan = plan_sessions(study.study);
  for (std::size_t session = 1; session <= plan.size(); ++session) {
    const std::string text = std::to_string(session);
    log.append(event_of("session", {{"session", text}, {"observer", observer}, {"level", "formula"}}));
    course.begin_session(static_cast<int>(session));
    const int planned = planned_trials(plan[session - 1]);
    bool last_second = false;
    int block = 1;
    std::string task;
    for (int done = 0; const auto trial = course.next(); ++done) {
      const bool is_new = !task.empty() && task != study.study.tasks[trial->task].name;
      if (is_new || (done > 0 && done % study.study.break_trials == 0)) ++block;
      TrialRecord record = record_of(study.study, *trial, static_cast<int>(session), block);
      task = record.task;
      record.time = utc_now();
      const double progress = planned > 0 ? std::min(1.0, static_cast<double>(done) / planned) : 0.0;
      answer_by_formula(study.study, person, *trial, progress, last_second, study.study.seed, number, record);
      last_second = record.answer == 2;
      log.append(record);
      course.add(record);
    }
    log.append(event_of("session-end", {{"session", text}}));
  }
}

}  // namespace palpate::experiment
