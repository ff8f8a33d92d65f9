#include "study/session/session_questions.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>

#include "core/base/random.h"
#include "core/base/text.h"
#include "io/system/input_file.h"
#include "io/system/sha256.h"
#include "palpate/error.h"
#include "palpate/session.h"

#include "study/session/block_scene.h"
#include "study/session/interval_meter.h"
#include "study/session/observer_hand.h"

namespace palpate::study {
namespace {

constexpr int kAudibleTrials = 20;
constexpr double kAudibleMinutes = 30.0;
constexpr std::uint32_t kAudiblePart = 0x7500'0000;  // of the random numbers
constexpr InputKind kConsentInput{"a consent text", std::uint64_t{1} << 20U};

double hours_since(const std::string& time) {
  const double then = seconds_of(time);
  return then > 0.0 ? (static_cast<double>(std::time(nullptr)) - then) / 3600.0 : 0.0;
}

/// Question for an entry of [participants] ask; its answers are bands only.
Question question_of(const std::string& entry) {
  if (entry == "age_band")
    return {"participant", "Your age?", {"18-29", "30-39", "40-49", "50-59", "60 or more"}};
  if (entry == "hand") return {"participant", "Your dominant hand?", {"left", "right", "both"}};
  return {
      "participant", "Your experience with palpation, in years?", {"none", "below 1", "1-5", "more than 5"}};
}

}  // namespace

bool SessionQuestions::still_wanted() const {
  const std::vector<TrialRecord>& trials = log_.opened().trials;
  if (options_.screens == nullptr || trials.empty()) return true;
  if (std::fabs(hours_since(trials.back().time)) < 24.0) return true;  // also when the clock was set back
  const auto answer = options_.screens->ask(
      {"experimenter",
       "The last trial of this session was on " + trials.back().time + ". Go on with it?",
       {"go on", "stop"}});
  return answer && *answer == 0;
}

bool SessionQuestions::has(const std::string& event, const std::string& answer) const {
  const std::vector<EventRecord>& events = log_.opened().events;
  return std::any_of(events.begin(), events.end(), [&](const EventRecord& seen) {
    return seen.event == event && (answer.empty() || seen.value("answer") == answer);
  });
}

bool SessionQuestions::consent_and_bands() {
  const bool file = !study_.study.consent_file.empty();
  if ((file || !study_.study.language.consent.empty()) && !has("consent", "yes")) {
    const std::string text =
        file ? InputFile(study_.folder / study_.study.consent_file, kConsentInput).read_rest()
             : study_.study.language.consent;
    const auto answer = options_.screens->ask({"participant", text, {"I agree", "I do not agree"}});
    if (!answer) return false;
    log_.append(event_of("consent", {{"answer", *answer == 0 ? "yes" : "no"}, {"hash", sha256(text)}}));
    if (*answer != 0) return false;
  }
  if (!has("answers")) {
    std::vector<std::pair<std::string, std::string>> answers;
    for (const std::string& entry : study_.study.ask) {
      const Question question = question_of(entry);
      const auto answer = options_.screens->ask(question);
      if (!answer) return false;
      answers.emplace_back(entry, question.answers[*answer]);
    }
    if (!answers.empty()) log_.append(event_of("answers", answers));
  }
  return true;
}

bool SessionQuestions::instruct(const StudyTask& task) {
  if (options_.screens == nullptr) return true;
  return options_.screens->ask({"participant", describe(task.kind).instructions, {"Go on"}}).has_value();
}

bool SessionQuestions::threshold_at_edge(const Course::Threshold& threshold) {
  if (options_.screens == nullptr) return true;
  const std::string value = brief(1e3 * std::pow(10.0, threshold.log10.mean), 3);
  const auto answer = options_.screens->ask(
      {"experimenter",
       "The noise threshold of this person lies at the " +
           std::string(threshold.above ? "largest" : "least") + " stimulus (" + value +
           " mN), so it may be beyond that. Check that the device gives the noise and the hand holds the "
           "handle as asked. These trials are not run again: stop, and prepare a study with a wider "
           "sigma_mN, or go on with this value, which flags the person in the report.",
       {"stop the session", "go on with this value"}});
  return answer && *answer == 1;
}

bool SessionQuestions::audibility(int session) {
  if (!study_.study.check_audible || session != 1 || has("audible")) return true;
  session::SessionOptions session_options;
  session_options.preparation = options_.preparation;
  session_options.duration_s = kAudibleMinutes * 60.0;
  scene::Scene scene = study_scene(study_.study, options_.device);
  if (!options_.observer.empty()) session_options.devices.push_back(std::make_unique<ObserverHand>(scene));
  session::Session run(std::move(scene), std::move(session_options));
  const auto background = run.run_in_background();
  const auto switch_noise = [&](bool on) {
    run.updates().offer(haptics::LiveNoise{on, study_.study.max_noise * kFarAway, kFarAway});
  };
  // Answers of a check that was interrupted count.
  int first = 0;
  int correct = 0;
  for (const EventRecord& event : log_.opened().events) {
    if (event.event != "audible-trial") continue;
    ++first;
    correct += event.value("correct") == "1" ? 1 : 0;
  }
  for (int i = first; i < kAudibleTrials; ++i) {
    Random random(study_.study.seed, participant_, kAudiblePart + static_cast<std::uint32_t>(i));
    const std::optional<bool> answer =
        options_.screens->audible_trial({i + 1, kAudibleTrials, random.uniform() < 0.5}, switch_noise);
    if (!answer) return false;
    if (background->ended())
      throw InputError("the check whether the noise is heard: the device's run has ended");
    correct += *answer ? 1 : 0;
    log_.append(
        event_of("audible-trial", {{"trial", std::to_string(i + 1)}, {"correct", *answer ? "1" : "0"}}));
  }
  log_.append(event_of("audible",
                       {{"trials", std::to_string(kAudibleTrials)}, {"correct", std::to_string(correct)}}));
  return true;
}

void SessionQuestions::blinding(const LastTrial& last) {
  if (!study_.study.check_blinding || options_.screens == nullptr) return;
  for (const std::string who : {"participant", "experimenter"}) {
    const std::vector<std::string> answers = {"yes", "no", "unsure"};
    const char* question = who == "participant" ? "Did the tool tingle in the last trial?"
                                                : "Was there noise in the last trial?";
    const auto noise = options_.screens->ask({who, question, answers});
    if (!noise) return;
    const auto sure = options_.screens->ask(
        {who, "How sure are you? 1: not at all, 5: completely", {"1", "2", "3", "4", "5"}});
    if (!sure) return;
    log_.append(event_of("blinding", {{"who", who},
                                      {"session", std::to_string(last.session)},
                                      {"block", std::to_string(last.block)},
                                      {"task", last.task},
                                      {"code", last.code},
                                      {"answer", answers[*noise]},
                                      {"confidence", std::to_string(*sure + 1)}}));
  }
}

void SessionQuestions::say_goodbye() {
  static_cast<void>(options_.screens->ask(
      {"participant", "The session is over. Thank you! Take your hand off the device.", {"Close"}}));
}

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
