#include "study/session/session_markers.h"

#include "core/base/text.h"
#include "palpate/error.h"

#include "study/session/session_questions.h"

namespace palpate::study {

SessionMarkers::SessionMarkers(const Study& study, const SessionOptions& options, LogWriter& log)
    : study_(study), options_(options), log_(log) {
  if (options.screens == nullptr) return;  // offline, ticks have no time
  const std::string who = options.markers ? "--markers" : study.file.string() + ": markers.to";
  for (const std::string& text : options.markers.value_or(study.markers)) {
    targets_.push_back(parse_marker_target(text, who));
  }
}

void SessionMarkers::open() {
  if (!targets_.empty()) markers_.emplace(targets_);
}

std::string SessionMarkers::text() const {
  std::vector<std::string> texts;
  if (markers_) {
    for (const MarkerTarget& target : targets_) texts.push_back(target.text);
  }
  return texts.empty() && !study_.markers.empty() ? "none" : joined(texts);
}

void SessionMarkers::begin_block(int session, int block, double rate_Hz) {
  session_ = session;
  block_ = block;
  if (markers_) markers_->begin_block(rate_Hz);
}

void SessionMarkers::send(MarkerCode code, std::uint64_t tick, const std::string& task, const Trial& trial) {
  if (markers_) markers_->send({code, tick, session_, block_, task, trial.number, trial.practice});
}

void SessionMarkers::note(const std::string& state, const std::string& reason) {
  log_.append(event_of("markers", {{"session", std::to_string(session_)},
                                   {"block", std::to_string(block_)},
                                   {"state", state},
                                   {"reason", reason}}));
}

std::vector<std::pair<std::string, std::string>> SessionMarkers::finish_block() {
  if (!markers_) return {};
  const Markers::Report report = markers_->finish_block();
  if (failed()) {
    failure_ = markers_->failure();
    note("failed", failure_);
  }
  return {{"markers", std::to_string(report.sent)},
          {"markers_lost", std::to_string(report.lost)},
          {"markers_late_ms", brief(1e-6 * static_cast<double>(report.worst_late), 3)}};
}

bool SessionMarkers::settle() {
  if (!failed()) return true;
  while (true) {
    markers_.reset();
    const auto answer = options_.screens->ask(
        {"experimenter",
         "Markers failed: " + failure_ + ". The other instrument lacks those of the last trial or trials.",
         {"try again", "go on without markers", "stop the session"}});
    if (!answer || *answer == 2) {
      note("stop", "");
      return false;
    }
    if (*answer == 1) {
      note("off", "");
      targets_.clear();
      failure_ += "; the session went on without markers";
      return true;
    }
    try {
      open();
      note("on", "");
      return true;
    } catch (const InputError& error) {
      failure_ = error.what();
    }
  }
}

}  // namespace palpate::study
