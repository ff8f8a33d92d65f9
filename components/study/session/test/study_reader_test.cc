#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"

#include "study/session/study.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> task_names(const Study& study) {
  std::vector<std::string> names;
  for (const StudyTask& task : study.tasks) names.push_back(task.name);
  return names;
}

/// The message for a text, without "s.toml:".
std::string error_in(const std::string& text) {
  const std::string error = error_of([&] { static_cast<void>(parse_study(text, "s.toml")); });
  return error.starts_with("s.toml:") ? error.substr(7) : error;
}

std::string error_with(const std::string& from, const std::string& to) {
  return error_in(replaced(kStudyText, from, to));
}

class ExampleStudy : public testing::Test {
 protected:
  Study study_ = load_study(PALPATE_EXAMPLES "/study/touch-noise.toml");
  [[nodiscard]] const StudyTask& task(const std::string& name) const {
    return study_.tasks.at(study_.find_task(name).value());
  }
};

TEST_F(ExampleStudy, RunsTasksAfterThoseThatTheyTakeAValueFrom) {
  EXPECT_THAT(task_names(study_),
              ElementsAre("threshold", "weak-force", "curve", "stiffness", "lump", "hold"));
  EXPECT_EQ(study_.threshold_task(), 0U);
}

TEST_F(ExampleStudy, HasItsTablesInSiUnits) {
  EXPECT_EQ(study_.name, "touch-noise-1");
  EXPECT_EQ(study_.scene, "gallbladder");
  EXPECT_EQ(study_.seed, 20260301U);
  EXPECT_EQ(study_.sessions, 4);
  EXPECT_EQ(study_.consent_file, "consent-en.md");
  EXPECT_EQ(study_.approval, "");
  EXPECT_TRUE(study_.random_ids);
  EXPECT_THAT(study_.ask, ElementsAre("age_band", "hand", "palpation_experience_years"));
  EXPECT_EQ(study_.max_noise, 0.1);
  EXPECT_EQ(study_.max_continuous_noise, 3.0);
  EXPECT_EQ(study_.sound_level_dB, -20.0);
  EXPECT_THAT(study_.first_keys, ElementsAre("1", "f", "pedal-left", "pad:x"));
  EXPECT_EQ(study_.timeout, 8.0);
  EXPECT_EQ(study_.homing_radius, 0.01);
  EXPECT_EQ(study_.break_trials, 30);
  EXPECT_TRUE(study_.check_audible && study_.check_blinding);
  EXPECT_EQ(study_.exclude_catch_below, 0.7);
}

TEST_F(ExampleStudy, HasTheStimuliOfEachTask) {
  const StudyTask& threshold = task("threshold");
  EXPECT_EQ(threshold.kind, TaskKind::kNoiseThreshold);
  EXPECT_EQ(threshold.catch_share, 0.1);
  EXPECT_TRUE(threshold.repeat_at_end);
  EXPECT_THAT(threshold.least, DoubleEq(1e-3));
  EXPECT_THAT(threshold.largest, DoubleEq(0.1));
  EXPECT_EQ(threshold.band_high, 1.5);
  EXPECT_EQ(task("curve").signal->task, "weak-force");
  EXPECT_EQ(task("curve").signal->correct, 0.65);
  EXPECT_EQ(task("curve").trials, 40);
  EXPECT_EQ(task("stiffness").standard_k1, 18.0);
  EXPECT_THAT(task("stiffness").depth, DoubleEq(8e-3));
  EXPECT_EQ(task("stiffness").steps, 14);
  EXPECT_EQ(task("lump").practice, 26);
  EXPECT_EQ(task("lump").search_time, 15.0);
  EXPECT_THAT(task("hold").targets, ElementsAre(1.0, 2.0, 4.0));
  EXPECT_EQ(task("hold").trials, 15);
}

TEST_F(ExampleStudy, HasOneArmPerShareOrCondition) {
  const std::vector<Arm>& shares = task("curve").arms;
  ASSERT_EQ(shares.size(), 6U);
  EXPECT_EQ(shares[1].name, "0.3");
  EXPECT_EQ(shares[5].share, 2.5);
  EXPECT_EQ(shares[5].profile, NoiseProfile::kConstant);
  const std::vector<Arm>& conditions = task("lump").arms;
  ASSERT_EQ(conditions.size(), 3U);
  EXPECT_EQ(conditions[2].name, "paper");
  EXPECT_EQ(conditions[2].profile, NoiseProfile::kProximity);
  EXPECT_THAT(conditions[2].d0, DoubleEq(5e-3));
  EXPECT_EQ(task("threshold").arms.size(), 1U);
  EXPECT_FALSE(task("threshold").has_noise());
}

TEST_F(ExampleStudy, HasThePreregisteredAnalyses) {
  EXPECT_EQ(study_.primary->condition, "constant");
  EXPECT_EQ(study_.primary->reference, "off");
  EXPECT_EQ(study_.primary->measure, "ln_jnd");
  EXPECT_EQ(study_.primary->alternative, "less");
  EXPECT_THAT(study_.inverted_u->first, ElementsAre(0.0));
  EXPECT_THAT(study_.inverted_u->middle, ElementsAre(0.6, 0.9));
  EXPECT_THAT(study_.inverted_u->last, ElementsAre(2.5));
}

// 1.5 N of the band, 0.5 N commanded, 6 x 0.1 N of noise; a hold of 4 N with noise.
TEST_F(ExampleStudy, BoundsTheForceOfEachTask) {
  EXPECT_THAT(force_bound(study_, task("threshold")).sum(), DoubleEq(2.1));
  EXPECT_THAT(force_bound(study_, task("weak-force")).sum(), DoubleEq(2.0));
  EXPECT_THAT(force_bound(study_, task("curve")).sum(), DoubleEq(2.6));
  EXPECT_THAT(force_bound(study_, task("stiffness")).sum(), DoubleEq(0.6));
  EXPECT_THAT(force_bound(study_, task("hold")).sum(), DoubleEq(4.6));
}

TEST(StudyReader, SortsTasksAndGivesDefaults) {
  const Study study = parse_study(kStudyText, "s.toml");
  EXPECT_THAT(task_names(study), ElementsAre("weak", "threshold", "curve", "stiff", "lump", "hold"));
  EXPECT_EQ(study.primary->measure, "ln_jnd");
  EXPECT_EQ(study.primary->alternative, "two-sided");
  EXPECT_THAT(study.first_keys, ElementsAre("1", "f"));
}

TEST(StudyReader, ReadsStaircasesAndConstantStimuli) {
  const std::string text = replaced(kStudyText, "trials = 7", "method = \"staircase\"");
  EXPECT_EQ(parse_study(text, "s").tasks[3].method, Method::kStaircase);
  EXPECT_EQ(parse_study(replaced(text, "trials = 5", "method = \"constant\""), "s").tasks[0].method,
            Method::kConstant);
  EXPECT_EQ(error_with("trials = 5", "method = \"quest\""),
            "23: task.method = \"quest\": must be questplus, staircase or constant");
}

/// A fault in the small study and its message.
struct BadStudy {
  std::string from;
  std::string to;
  std::string error;
};

void expect_errors(const std::vector<BadStudy>& studies) {
  for (const BadStudy& bad : studies) EXPECT_EQ(error_with(bad.from, bad.to), bad.error) << bad.to;
}

TEST(StudyReader, NamesTheFaultsOfTables) {
  expect_errors(
      {{"[study]\nname = \"small\"\nscene = \"box\"\n", "",
        "1: study: missing, must be a table [study] with name and scene"},
       {"name = \"small\"\n", "",
        "1: study.name: missing, must be a name of at most 40 letters, digits, '.', '-' or '_'"},
       {"name = \"small\"", "name = \"a b\"",
        "2: study.name = \"a b\": must be a name of at most 40 letters, digits, '.', '-' or '_'"},
       {"scene = \"box\"\n", "", "1: study.scene: missing, must be a scene file or a built-in organ"},
       {"scene = \"box\"", "scene = \"box\"\nsessions = 0",
        "4: study.sessions = 0: must be a whole number from 1 to 50"},
       {"scene = \"box\"", "scene = \"box\"\nmax_minutes = 1",
        "4: study.max_minutes = 1: must be a number >= 5 and <= 480"},
       {"scene = \"box\"", "scene = \"box\"\n[participants]\nask = [\"name\"]",
        "5: participants.ask = [ 'name' ]: \"name\" is unknown, must be age_band, hand or "
        "palpation_experience_years"},
       {"scene = \"box\"", "scene = \"box\"\n[participants]\nid = \"name\"",
        "5: participants.id = \"name\": must be random or numbered"},
       {"scene = \"box\"", "scene = \"box\"\n[screen]\nparticipant = \"organ\"",
        "5: screen.participant = \"organ\": must be blank"},
       {"scene = \"box\"", "scene = \"box\"\n[response]\nfirst = [\"2\"]",
        "4: response.second: \"2\" is also in `first`, must be in one of them"},
       {"scene = \"box\"", "scene = \"box\"\n[response]\nfirst = []",
        "5: response.first = []: must be a list of texts [\"a\", \"b\", ...], each not empty, on one line"},
       {"scene = \"box\"", "scene = \"box\"\n[homing]\nplace = \"here\"",
        "5: homing.place = \"here\": must be rest"},
       {"scene = \"box\"", "scene = \"box\"\n[breaks]\nevery_trials = 1.5",
        "5: breaks.every_trials = 1.5: must be a whole number from 1 to 1000"},
       {"max_force_N = 6.0", "max_force_N = 60",
        "5: safety.max_force_N = 60: must be a number > 0 and <= 50"},
       {"name = \"on\"", "name = \"off\"",
        "11: condition.name = \"off\": is the name of an earlier condition, must be another"},
       {"share = 0.6", "share = -1", "12: condition.share = -1: must be a number >= 0 and <= 10"},
       {"share = 0.6", "d0_mm = 3\nshare = 0.6", "12: condition.d0_mm = 3: needs profile = \"proximity\""},
       {"share = 0.6", "", "10: condition.share: missing, must be a number >= 0 and <= 10"}});
}

TEST(StudyReader, NamesTheFaultsOfTasks) {
  expect_errors(
      {{"max_force_N = 6.0", "max_force_N = 2.5",
        "14: task.name = \"curve\": its largest force is 2.6 N = 1.5 (tissue) + 0.5 (commanded) + 0.6 (6 "
        "standard deviations of noise), must be at most safety.max_force_N, 2.5 N"},
       {"max_force_N = 6.0", "max_force_N = 2",
        "45: task.target_N = [ 1, 2 ]: each must be below safety.max_force_N, 2 N"},
       {"name = \"weak\"", "name = \"curve\"",
        "20: task.name = \"curve\": is the name of an earlier task, must be another"},
       {"kind = \"stiffness\"", "kind = \"stifness\"",
        "32: task.kind = \"stifness\": \"stifness\" is unknown, must be noise-threshold, force-detection, "
        "stiffness, inclusion or force-control; did you mean stiffness?"},
       {"kind = \"stiffness\"\n", "",
        "30: task.kind: missing, must be noise-threshold, force-detection, stiffness, inclusion or "
        "force-control"},
       {"from_task = \"weak\"", "from_task = \"week\"",
        "16: task.signal.from_task = \"week\": \"week\" is unknown, must be curve, weak, threshold, stiff, "
        "lump or hold; did you mean weak?"},
       {"from_task = \"weak\"", "from_task = \"curve\"",
        "16: task.signal.from_task = \"curve\": must be a force-detection task with force_mN, in which one "
        "arm has no noise"},
       {"from_task = \"weak\"", "from_task = \"stiff\"",
        "16: task.signal.from_task = \"stiff\": must be a force-detection task with force_mN, in which one "
        "arm has no noise"},
       {"from_task = \"weak\"", "correct = 0.6",
        "16: task.signal.from_task: missing, must be a force-detection task with force_mN"},
       {"from_task = \"weak\"", "from_task = \"weak\", correct = 1",
        "16: task.signal.correct = 1: must be a number >= 0.51 and <= 0.99"},
       {"shares = [0, 0.5, 2]", "shares = [0, 0.5, 0.5]",
        "17: task.shares = [ 0, 0.5, 0.5 ]: 0.5 is listed twice"},
       {"shares = [0, 0.5, 2]", "shares = [0, 0.5, 20]",
        "17: task.shares = [ 0, 0.5, 20 ]: must be a list of numbers [a, b, ...], each a number >= 0 and <= "
        "10"},
       {"shares = [0, 0.5, 2]", "shares = [0, 0.5, 2]\nconditions = [\"on\"]",
        "18: task.conditions = [ 'on' ]: must be left out with `shares`"},
       {"shares = [0, 0.5, 2]", "shares = [0, 0.5, 2]\nmethod = \"constant\"",
        "18: task.method = \"constant\": must be left out with `signal`, which fixes the force"},
       {"trials = 4", "trials = 4\ntrials_per_level = 4",
        "19: task.trials_per_level = 4: must be left out with `trials`, which means the same"},
       {"trials = 4", "trials = 0", "18: task.trials = 0: must be a whole number from 1 to 10000"},
       {"force_mN = { from = 5, to = 500 }\n", "",
        "19: task.force_mN: missing, must be { from = ..., to = ..., per_decade = ... }"},
       {"force_mN = { from = 5, to = 500 }", "force_mN = { from = 5, to = 4 }",
        "22: task.force_mN.to = 4: must be above `from`"},
       {"force_mN = { from = 5, to = 500 }", "force_mN = { from = 5, to = 5.1 }",
        "22: task.force_mN.to = 5.1: is too near to the least stimulus"},
       {"force_mN = { from = 5, to = 500 }", "force_mN = { from = 5, to = 500, steps = 3 }",
        "22: task.force_mN.steps = 3: unknown key, valid are from, to or per_decade"},
       {"sigma_mN = { from = 1, to = 100 }", "sigma_mN = { from = 1, to = 101 }",
        "27: task.sigma_mN.to = 101: must be at most safety.max_noise_N, 100 mN"},
       {"sets_share_of = \"threshold\"\n", "",
        "17: task.shares = [ 0, 0.5, 2 ]: needs a task of kind noise-threshold with sets_share_of = "
        "\"threshold\""},
       {"sets_share_of = \"threshold\"", "sets_share_of = \"noise\"",
        "28: task.sets_share_of = \"noise\": must be threshold"},
       {"sets_share_of = \"threshold\"", "sets_share_of = \"threshold\"\ninterval_s = 4",
        "29: task.interval_s = 4: must be at most safety.max_continuous_noise_s, 3 s"},
       {"sets_share_of = \"threshold\"", "sets_share_of = \"threshold\"\nforce_band_N = [2, 1]",
        "29: task.force_band_N = [ 2, 1 ]: must be two numbers [low, high], low < high"},
       {"sets_share_of = \"threshold\"",
        "sets_share_of = \"threshold\"\nforce_band_N = [1, 2]\nhold = \"free\"",
        "29: task.force_band_N = [ 1, 2 ]: must be left out with hold = \"free\""},
       {"[[task]]\nname = \"stiff\"",
        "[[task]]\nname = \"again\"\nkind = \"noise-threshold\"\nsigma_mN = { from = 1, to = 9 "
        "}\nsets_share_of = \"threshold\"\n[[task]]\nname = \"stiff\"",
        "34: task.sets_share_of = \"threshold\": only one task may set it, and threshold does"},
       {"ratio = { least = 1.02, largest = 3.3 }", "ratio = { least = 1, largest = 3.3 }",
        "33: task.ratio.least = 1: must be a number >= 1.001 and <= 100"},
       {"ratio = { least = 1.02, largest = 3.3 }\n", "",
        "30: task.ratio: missing, must be { least = ..., largest = ..., steps = ... }"},
       {"ratio = { least = 1.1, largest = 8 }", "ratio = { least = 50, largest = 51 }",
        "39: task.ratio.largest = 51: is too near to the least stimulus"},
       {"conditions = [\"off\", \"on\"]\ntrials = 7", "conditions = [\"off\", \"onn\"]\ntrials = 7",
        "34: task.conditions = [ 'off', 'onn' ]: \"onn\" is unknown, must be off or on; did you mean on?"},
       {"conditions = [\"off\", \"on\"]\ntrials = 7", "conditions = [\"off\", \"off\"]\ntrials = 7",
        "34: task.conditions = [ 'off', 'off' ]: off is listed twice"},
       {"depth_mm = 6\n", "", "36: task.depth_mm: missing, must be a number > 0 and <= 200"},
       {"target_N = [1, 2]", "target_N = [1, 6]",
        "45: task.target_N = [ 1, 6 ]: each must be below safety.max_force_N, 6 N"},
       {"target_N = [1, 2]", "target_N = [1, 5.5]",
        "43: task.name = \"hold\": its largest force is 6.1 N = 5.5 (tissue) + 0 (commanded) + 0.6 (6 "
        "standard deviations of noise), must be at most safety.max_force_N, 6 N"},
       {"target_N = [1, 2]\n", "", "42: task.target_N: missing, must be a list of forces [a, b, ...]"},
       {"repeats = 3", "trials = 3",
        "46: task.trials = 3: must be left out, it is the number of targets x repeats"}});
}

TEST(StudyReader, NamesTheFaultsOfAnalyses) {
  expect_errors({{"contrast = \"on - off\"", "contrast = \"on-off\"",
                  "49: analysis.primary.contrast = \"on-off\": must be \"CONDITION - REFERENCE\", two "
                  "different ones of off or on"},
                 {"contrast = \"on - off\"", "contrast = \"on - of\"",
                  "49: analysis.primary.contrast = \"on - of\": \"of\" is unknown, must be off or on; did "
                  "you mean off?"},
                 {"contrast = \"on - off\"", "contrast = \"on - on\"",
                  "49: analysis.primary.contrast = \"on - on\": must be \"CONDITION - REFERENCE\", two "
                  "different ones of off or on"},
                 {"contrast = \"on - off\"", "contrast = \"on - off\", measure = \"d_prime\"",
                  "49: analysis.primary.measure = \"d_prime\": must be ln_jnd"},
                 {"contrast = \"on - off\"", "contrast = \"on - off\", alternative = \"more\"",
                  "49: analysis.primary.alternative = \"more\": must be less, greater or two-sided"},
                 {"task = \"stiff\"", "task = \"stif\"",
                  "49: analysis.primary.task = \"stif\": \"stif\" is unknown, must be weak, threshold, "
                  "curve, stiff, lump or hold; did you mean stiff?"},
                 {"task = \"stiff\"", "task = \"lump\"",
                  "49: analysis.primary.task = \"lump\": must be a task with two or more conditions"},
                 {"rise = [[0.5], [0]]", "rise = [[0.5], [0.1]]",
                  "50: analysis.inverted_u.rise = [ [ 0.5 ], [ 0.10000000000000001 ] ]: \"0.1\" is unknown, "
                  "must be 0, 0.5 or 2; did you mean 0.5?"},
                 {"rise = [[0.5], [0]]", "rise = [[0.5]]",
                  "50: analysis.inverted_u.rise = [ [ 0.5 ] ]: must be two lists of shares [[...], [...]]: "
                  "the first minus the second"},
                 {"rise = [[0.5], [0]]", "rise = [0.5]",
                  "50: analysis.inverted_u.rise = [ 0.5 ]: must be a list of lists of numbers [[a, ...], [b, "
                  "...]], each a finite number >= 0"},
                 {"rise = [[0.5], [0]]", "rise = [[2], [0]]",
                  "50: analysis.inverted_u.fall = [ [ 2 ], [ 0.5 ] ]: its second list must be the first list "
                  "of `rise`"},
                 {"rise = [[0.5], [0]], fall = [[2], [0.5]]", "rise = [[0], [0.5]], fall = [[2], [0]]",
                  "50: analysis.inverted_u.rise = [ [ 0 ], [ 0.5 ] ]: the shares of the first list must be "
                  "above those of the second"},
                 {"fall = [[2], [0.5]]", "fall = [[0], [0.5]]",
                  "50: analysis.inverted_u.fall = [ [ 0 ], [ 0.5 ] ]: the shares of the first list must be "
                  "above those of the second"},
                 {"task = \"curve\"", "task = \"lump\"",
                  "50: analysis.inverted_u.task = \"lump\": must be a force-detection task with `signal` and "
                  "three or more shares"}});
}

TEST(StudyReader, NamesTheNearestKey) {
  EXPECT_THAT(error_with("[analysis]", "[analyses]"), HasSubstr("unknown key, did you mean analysis?"));
  EXPECT_EQ(error_with("depth_mm = 6", "depth = 6"),
            "40: task.depth = 6: unknown key, did you mean depth_mm?");
  EXPECT_EQ(error_with("repeats = 3", "ratio = 3"),
            "46: task.ratio = 3: unknown key, valid are name, kind, practice, practice_until, examples, "
            "repeat_at_end, trials, target_N, repeats or conditions");
}

TEST(StudyReader, NeedsATask) {
  EXPECT_EQ(error_in("[study]\nname = \"a\"\nscene = \"box\"\n"),
            "1: task: missing, must be one or more tables [[task]]");
}

TEST(StudyReader, NamesAFileThatDoesNotExist) {
  EXPECT_EQ(error_of([] { static_cast<void>(load_study("absent.toml")); }),
            "absent.toml: there is no such file");
}

// A random change of one byte gives either a study with a plan, or an InputError that names the file.
TEST(StudyReader, ReadsOrRefusesAnyText) {
  constexpr std::uint64_t kSeed = 7;
  int read = 0;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    Random random(kSeed, i, 0);
    std::string text = kStudyText;
    char& changed = text[random.below(text.size())];
    const bool digit = changed >= '0' && changed <= '9';
    changed = static_cast<char>(digit ? '0' + static_cast<int>(random.below(10))
                                      : ' ' + static_cast<int>(random.below(95)));
    try {
      const Study study = parse_study(text, "s.toml");
      for (const StudyTask& task : study.tasks) EXPECT_FALSE(task.arms.empty());
      static_cast<void>(plan_sessions(study));
      ++read;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("s.toml:"));
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 2000);
}

TEST(StudyReader, LevelsOfMaskAndMotorsAreTheLabs) {
  const Study study = parse_study(
      replaced(kStudyText, "[safety]", "[sound]\nmask_dBA = 68\nmotors_dBA = 41.5\n[safety]"), "s.toml");
  EXPECT_EQ(sound_text(study), "mask 68 dB(A), motors 41.5 dB(A) at the ears, as the lab measured");
  EXPECT_EQ(sound_text(parse_study(kStudyText, "s.toml")), "");
  EXPECT_THAT(error_in(replaced(kStudyText, "[safety]", "[sound]\nmask_dBA = 200\n[safety]")),
              testing::HasSubstr("sound.mask_dBA = 200"));
}

}  // namespace
}  // namespace palpate::study
