#include "study/session/simulate.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "io/system/input_file.h"
#include "io/system/temporary.h"
#include "io/system/whole_file.h"

#include "study/session/course.h"
#include "study/session/session_questions.h"

namespace palpate::study {
namespace {

// A simulated session begins at nine o'clock, one a day from this one on.
constexpr std::int64_t kFirstMorning = 946'717'200;  // 2000-01-01T09:00:00Z
constexpr std::int64_t kDay = 86'400;

std::string time_of(int session, double seconds) {
  return utc_time(1000 * (kFirstMorning + (session - 1) * kDay + static_cast<std::int64_t>(seconds)));
}

}  // namespace

ParticipantLog simulate_trials(const Study& study, SealedKey key, std::uint32_t participant,
                               SimulatedPerson person) {
  ParticipantLog log;
  log.id = "S" + std::to_string(participant + 1);
  Course course(study, key, participant);
  const auto sessions = static_cast<int>(plan_sessions(study, participant).size());
  for (int session = 1; session <= sessions; ++session) {
    double seconds = 0.0;
    const auto add_event = [&](const char* event, std::vector<std::pair<std::string, std::string>> values) {
      log.events.push_back({time_of(session, seconds), event, std::move(values), log.trials.size()});
    };
    bool noted = false;
    const std::string number = std::to_string(session);
    add_event("session", {{"session", number}, {"observer", person.kind}, {"level", "formula"}});
    course.begin_session(session);
    const int planned = std::max(course.trials_left(), 1);
    int block = 1;
    int in_block = 0;
    std::size_t task = 0;
    for (int done = 0; const auto trial = course.next(); ++done) {
      if (in_block == study.break_trials || (done > 0 && task != trial->task)) {
        ++block;
        in_block = 0;
        seconds += study.break_least;
      }
      task = trial->task;
      ++in_block;
      seconds += trial_seconds(study, study.tasks[task]);
      const std::optional<Course::Threshold> threshold =
          !noted && course.uses_threshold() ? course.threshold() : std::nullopt;
      if (threshold) {
        noted = true;
        add_event("threshold",
                  threshold_event(session, *threshold, threshold->at_edge ? "go on" : "").values);
      }
      TrialRecord record = record_of(study, *trial, session, block);
      record.time = time_of(session, seconds);
      const double progress = std::min(1.0, static_cast<double>(done) / planned);
      answer_by_formula(study, person, *trial, progress, study.seed, participant, record);
      course.add(record);
      log.trials.push_back(std::move(record));
      if (const auto practised = practice_event(study, course, log.trials.back())) {
        add_event("practice", practised->values);
      }
    }
    add_event("session-end", {{"session", number}});
  }
  return log;
}

std::string simulate_log(const StudyFolder& study, SealedKey key, std::uint32_t participant,
                         const std::string& observer) {
  const ParticipantLog log =
      simulate_trials(study.study, key, participant, make_person(observer, study.study.seed, participant));
  const ScratchFolder scratch("palpate-study");
  const std::filesystem::path file = scratch.path() / "log.jsonl";
  {
    LogKey chain = study.log_key(study.ids.at(participant));
    chain.heads.clear();  // the log is not in the folder yet
    LogWriter writer(file, chain, LogWriter::Sync::kAtEnd);
    std::size_t trial = 0;
    for (const EventRecord& event : log.events) {
      while (trial < event.after_trials) writer.append(log.trials[trial++]);
      writer.append(event);
    }
  }
  constexpr InputKind kSimulatedLog{"a simulated log", std::uint64_t{256} << 20};
  return InputFile(file, kSimulatedLog).read_rest();
}

void keep_log(const StudyFolder& study, const std::string& id, const std::string& log) {
  create_whole_file(study.log_of(id), log);
  const LogWriter checked(study.log_of(id), study.log_key(id));  // also writes its head
}

}  // namespace palpate::study
