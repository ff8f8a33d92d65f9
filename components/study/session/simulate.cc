#include "study/session/simulate.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/system/input_file.h"
#include "io/system/temporary.h"
#include "io/system/whole_file.h"
#include "palpate/error.h"

#include "study/session/course.h"
#include "study/session/simulated_person.h"

namespace palpate::study {
namespace {

// A simulated session begins at nine o'clock, one a day from this one on.
constexpr std::int64_t kFirstMorning = 946'717'200;  // 2000-01-01T09:00:00Z
constexpr std::int64_t kDay = 86'400;

std::string time_of(int session, double seconds) {
  return utc_time(1000 * (kFirstMorning + (session - 1) * kDay + static_cast<std::int64_t>(seconds)));
}

int planned_trials(const PlannedSession& session) {
  int trials = 0;
  for (const PlannedPart& part : session.parts) trials += part.trials;
  return trials;
}

/// One simulated participant at work.
class SimulatedCourse final {
 public:
  SimulatedCourse(const StudyFolder& study, SealedKey key, std::uint32_t participant,
                  const std::string& observer, LogWriter& log)
      : study_(study.study),
        participant_(participant),
        observer_(observer),
        log_(log),
        person_(make_person(observer, study.study.seed, participant)),
        course_(study.study, key, participant),
        plan_(plan_sessions(study.study)) {}

  void run() {
    for (std::size_t session = 1; session <= plan_.size(); ++session) run_session(static_cast<int>(session));
  }

 private:
  void append(const std::string& event, std::vector<std::pair<std::string, std::string>> values) {
    log_.append(EventRecord{time_of(session_, seconds_), event, std::move(values)});
  }

  void run_session(int session) {
    session_ = session;
    seconds_ = 0.0;
    const std::string number = std::to_string(session);
    append("session", {{"session", number}, {"observer", observer_}, {"level", "formula"}});
    course_.begin_session(session);
    const int planned = planned_trials(plan_[static_cast<std::size_t>(session - 1)]);
    int block = 1;
    int in_block = 0;
    std::string task;
    for (int done = 0; const auto trial = course_.next(); ++done) {
      const std::string& name = study_.tasks[trial->task].name;
      if (in_block == study_.break_trials || (!task.empty() && task != name)) {
        ++block;
        in_block = 0;
        seconds_ += study_.break_least;
      }
      task = name;
      ++in_block;
      seconds_ += trial_seconds(study_, study_.tasks[trial->task]);
      TrialRecord record = record_of(study_, *trial, session, block);
      record.time = time_of(session, seconds_);
      const double progress = planned > 0 ? std::min(1.0, static_cast<double>(done) / planned) : 0.0;
      answer_by_formula(study_, person_, *trial, progress, last_second_, study_.seed, participant_, record);
      last_second_ = record.answer == 2;
      log_.append(record);
      course_.add(record);
    }
    append("session-end", {{"session", number}});
  }

  const Study& study_;
  std::uint32_t participant_;
  const std::string& observer_;
  LogWriter& log_;
  SimulatedPerson person_;
  Course course_;
  std::vector<PlannedSession> plan_;
  int session_ = 1;
  double seconds_ = 0.0;
  bool last_second_ = false;
};

}  // namespace

std::string simulate_log(const StudyFolder& study, SealedKey key, std::uint32_t participant,
                         const std::string& observer) {
  const ScratchFolder scratch("palpate-study");
  const std::filesystem::path file = scratch.path() / "log.jsonl";
  {
    LogKey chain = study.log_key(study.ids.at(participant));
    chain.heads.clear();  // the log is not in the folder yet
    LogWriter log(file, chain, LogWriter::Sync::kAtEnd);
    SimulatedCourse(study, key, participant, observer, log).run();
  }
  constexpr InputKind kSimulatedLog{"a simulated log", std::uint64_t{256} << 20};
  return InputFile(file, kSimulatedLog).read_rest();
}

void keep_log(const StudyFolder& study, const std::string& id, const std::string& log) {
  create_whole_file(study.log_of(id), log);
  const LogWriter checked(study.log_of(id), study.log_key(id));  // also writes its head
}

}  // namespace palpate::study
