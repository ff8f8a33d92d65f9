#include "study/session/folder.h"

#include <algorithm>
#include <csignal>
#include <set>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "io/system/temporary.h"
#include "palpate/scene.h"

#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;
using testing::UnorderedElementsAre;

constexpr SealedKey kKey = 42;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

TEST(Codes, AreAPermutationThatDiffersBetweenParticipantsAndTasks) {
  std::set<std::vector<std::size_t>> seen;
  for (std::uint32_t participant = 0; participant < 50; ++participant) {
    std::vector<std::size_t> arms = arms_of_codes(kKey, participant, 2, 6);
    EXPECT_EQ(arms, arms_of_codes(kKey, participant, 2, 6));
    seen.insert(arms);
    std::sort(arms.begin(), arms.end());
    EXPECT_THAT(arms, ElementsAre(0, 1, 2, 3, 4, 5));
  }
  EXPECT_GT(seen.size(), 40U);
  EXPECT_NE(arms_of_codes(kKey, 0, 1, 6), arms_of_codes(kKey, 0, 2, 6));
}

// 600 participants, 3 codes: each arm has each code 200 times, with a standard deviation of 11.5.
TEST(Codes, HaveEachArmEquallyOften) {
  std::array<int, 3> first{};
  for (std::uint32_t participant = 0; participant < 600; ++participant) {
    ++first[arms_of_codes(kKey, participant, 0, 3)[0]];
  }
  for (const int times : first) EXPECT_NEAR(times, 200, 50);
}

TEST(Labels, AreAPermutationThatFollowsFromTheKey) {
  std::set<std::vector<std::size_t>> seen;
  for (SealedKey key = 0; key < 50; ++key) {
    std::vector<std::size_t> labels = labels_of_arms(key, 1, 3);
    seen.insert(labels);
    std::sort(labels.begin(), labels.end());
    EXPECT_THAT(labels, ElementsAre(0, 1, 2));
  }
  EXPECT_EQ(seen.size(), 6U);
}

/// A study file in a folder of its own, and a free folder to prepare.
class Folder : public testing::Test {
 protected:
  void SetUp() override { write_study("scene = \"box\"", "scene = \"box\""); }
  void write_study(const std::string& from, const std::string& to) {
    write_output(file_, replaced(kStudyText, from, to));
  }
  void prepare(int participants = 3) const { prepare_study(file_, study_, participants); }
  /// A scene file with an organ and a tissue of its own, in a folder beside it.
  void write_scene(const std::string& organ) const {
    fs::create_directories(folder_.path() / "scenes");
    fs::create_directories(folder_.path() / "data");
    write_output(folder_.path() / "scenes" / "own.toml",
                 "[organ]\nmesh = \"" + organ + "\"\nunit = \"mm\"\ntissue = \"../data/soft.toml\"\n" +
                     "[tool]\nmesh = \"sphere:5\"\n[safety]\nmax_force_N = 5\n");
    write_output(folder_.path() / "data" / "soft.toml", scene::to_toml(model::tissue_preset("liver")));
    write_output(folder_.path() / "data" / "organ.obj",
                 "v 0 0 0\nv 20 0 0\nv 0 30 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  }

  ScratchFolder folder_{"palpate-study"};
  fs::path file_ = folder_.path() / "small.toml";
  fs::path study_ = folder_.path() / "out" / "study";
};

TEST_F(Folder, HasTheStudyLockSealedKeyAndEmptyFolders) {
  prepare();
  EXPECT_THAT(names_in(study_), UnorderedElementsAre("study.toml", "lock.json", "sealed.json", "heads.txt",
                                                     "participants", "recordings"));
  EXPECT_EQ(bytes_of(study_ / "study.toml"), bytes_of(file_));
  EXPECT_THAT(names_in(folder_.path() / "out"), ElementsAre("study"));  // no temporary folder is left
  const StudyFolder opened = open_study(study_);
  EXPECT_EQ(opened.study.name, "small");
  EXPECT_EQ(opened.lock_hash, sha256(bytes_of(study_ / "lock.json")));
  EXPECT_FALSE(opened.unblinded() || opened.simulated);
  EXPECT_EQ(opened.recording_of("PABCD", 1, 3), study_ / "recordings" / "PABCD-s1-b03.h5");
  EXPECT_TRUE(opened.read(opened.ids[0]).trials.empty());
}

TEST_F(Folder, HasRandomIdsWithoutLookAlikes) {
  prepare(200);
  const std::vector<std::string> ids = open_study(study_).ids;
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 200U);
  for (const std::string& id : ids) EXPECT_THAT(id, MatchesRegex("P[234679CDFGHJKMNPQRTVWXYZ]{4}"));
}

TEST_F(Folder, HasNumberedIdsIfTheStudyWantsThem) {
  write_study("[safety]", "[participants]\nid = \"numbered\"\n[safety]");
  prepare();
  const StudyFolder opened = open_study(study_);
  EXPECT_THAT(opened.ids, ElementsAre("P01", "P02", "P03"));
  EXPECT_EQ(opened.number_of("P02"), 1U);
  EXPECT_EQ(error_of([&] { static_cast<void>(opened.number_of("P2")); }),
            study_.string() + ": participant P2: unknown id, did you mean P02?");
}

TEST_F(Folder, HasAKeyOfItsOwnThatOnlyTheOwnerCanRead) {
  prepare();
  const StudyFolder opened = open_study(study_);
  const SealedKey key = opened.key;
  struct stat facts {};
  ASSERT_EQ(stat((study_ / "sealed.json").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0600U);
  EXPECT_THAT(bytes_of(study_ / "lock.json"), testing::Not(HasSubstr(std::to_string(key))));
  prepare_study(file_, folder_.path() / "other", 3);
  EXPECT_NE(open_study(folder_.path() / "other").key, key);

  const std::string sealed = (study_ / "sealed.json").string();
  const auto open_error = [&] { return error_of([&] { static_cast<void>(open_study(study_)); }); };
  fs::permissions(sealed, fs::perms::group_read, fs::perm_options::add);
  EXPECT_EQ(
      open_error(),
      sealed + ": others can read it (mode 0640), must be readable by its owner only: chmod 600 " + sealed);
  fs::permissions(sealed, fs::perms::group_read, fs::perm_options::remove);
  write_output(sealed, "{\"key\":1}");
  EXPECT_EQ(open_error(), sealed + ": was changed after the study was prepared (lock.json)");
}

TEST_F(Folder, KeepsACopyOfTheSceneAndAllItsFiles) {
  write_scene("../data/organ.obj");
  write_study("scene = \"box\"", "scene = \"scenes/own.toml\"");
  prepare();
  fs::remove_all(folder_.path() / "data");
  const StudyFolder opened = open_study(study_);
  EXPECT_EQ(opened.study.scene, "scene/scenes/own.toml");
  const scene::Scene read = scene::load(scene_of(opened.study));
  EXPECT_EQ(read.organ.triangles.size(), 4U);
  EXPECT_EQ(read.safety.max_force, 5.0);  // lower than the study's 6 N
}

TEST_F(Folder, RefusesASceneWithAnAbsolutePath) {
  const std::string organ = (folder_.path() / "data" / "organ.obj").string();
  write_scene(organ);
  write_study("scene = \"box\"", "scene = \"scenes/own.toml\"");
  const std::string scene = (folder_.path() / "scenes" / "own.toml").string();
  EXPECT_EQ(error_of([&] { prepare(); }), scene + ":2: organ.mesh: " + organ +
                                              ": must be named by a path relative to the scene file, so that "
                                              "the study can keep a copy");
  EXPECT_FALSE(fs::exists(study_));
}

TEST_F(Folder, KeepsACopyOfTheConsentFile) {
  write_study("[safety]", "[ethics]\nconsent_file = \"consent.md\"\n[safety]");
  EXPECT_EQ(error_of([&] { prepare(); }), file_.string() + ": ethics.consent_file = \"consent.md\": " +
                                              (folder_.path() / "consent.md").string() +
                                              ": there is no such file");
  write_output(folder_.path() / "consent.md", "Do you agree?");
  prepare();
  const StudyFolder opened = open_study(study_);
  EXPECT_EQ(bytes_of(study_ / opened.study.consent_file), "Do you agree?");
}

TEST_F(Folder, NamesAFileThatWasChangedAfterwards) {
  write_scene("../data/organ.obj");
  write_output(folder_.path() / "consent.md", "Do you agree?");
  write_study("scene = \"box\"", "scene = \"scenes/own.toml\"\n[ethics]\nconsent_file = \"consent.md\"");
  prepare();
  for (const char* name : {"study.toml", "scene/scenes/own.toml", "scene/data/organ.obj",
                           "scene/data/soft.toml", "consent/consent.md"}) {
    const fs::path file = study_ / name;
    const std::string bytes = bytes_of(file);
    write_output(file, bytes + " ");
    EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
              file.string() + ": was changed after the study was prepared (lock.json)");
    fs::remove(file);
    EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
              file.string() + ": there is no such file");
    write_output(file, bytes);
  }
  EXPECT_EQ(open_study(study_).study.name, "small");
}

TEST_F(Folder, NamesABuiltInOrganThatDiffers) {
  prepare();
  const std::string lock = bytes_of(study_ / "lock.json");
  const std::size_t hash = lock.find("organ_sha256") + 16;
  std::string changed = lock;
  changed[hash] = changed[hash] == '0' ? '1' : '0';
  write_output(study_ / "lock.json", changed);
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
            "the mesh of the built-in organ box: was changed after the study was prepared (lock.json)");
}

TEST_F(Folder, WithAnotherLockIsRefused) {
  prepare();
  const std::string lock = (study_ / "lock.json").string();
  write_output(lock, "{\"format\":\"x\"}");
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
            lock + ": format = \"x\": must be \"palpate study 2\"");
  write_output(lock, "{}");
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
            lock + ": format: missing, must be a text");
  write_output(lock, "{\"format\": \"palpate study 1\", \"program\": 1}");
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }), lock + ": program = 1: must be a text");
  write_output(lock, "{");
  EXPECT_THAT(error_of([&] { static_cast<void>(open_study(study_)); }), StartsWith(lock + ": "));
  fs::remove(lock);
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
            study_.string() + ": has no lock.json, must be a folder made by `palpate study prepare`");
}

TEST_F(Folder, WithALockNestedSoDeepThatACopyWouldTakeTheStackIsRefused) {
  prepare();
  std::string lock = bytes_of(study_ / "lock.json");
  lock.insert(1, "\n\"z\": " + std::string(300'000, '[') + std::string(300'000, ']') + ",");
  write_output(study_ / "lock.json", lock);
  EXPECT_THAT(error_of([&] { static_cast<void>(open_study(study_)); }),
              AllOf(StartsWith((study_ / "lock.json").string() + ": line 2, byte 71 of "),
                    EndsWith(": is nested deeper than 64 levels")));
}

TEST_F(Folder, MayBeEmptyButNotInUse) {
  fs::create_directories(study_);
  prepare();
  EXPECT_EQ(error_of([&] { prepare(); }), study_.string() + ": is in use, must be a new or an empty folder");
}

TEST_F(Folder, IsPreparedFor1To999Participants) {
  for (const int participants : {0, 1000}) {
    EXPECT_EQ(error_of([&] { prepare(participants); }),
              "--participants " + std::to_string(participants) + ": must be a whole number from 1 to 999");
  }
  EXPECT_FALSE(fs::exists(study_));
}

TEST_F(Folder, IsNotPreparedForAStudyThatDoesNotFitIntoItsSessions) {
  write_study("scene = \"box\"", "scene = \"box\"\nmax_minutes = 5");
  EXPECT_THAT(error_of([&] { prepare(); }), HasSubstr("study.sessions = 1: the tasks need "));
}

TEST_F(Folder, OfAnOlderPalpateIsRefusedWithWhatToDo) {
  prepare();
  write_output(study_ / "lock.json", "{\"format\":\"palpate study 1\",\"program\":\"0.9.0\"}");
  EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
            study_.string() +
                ": was prepared by palpate 0.9.0, whose logs have no macs: go on with that version; "
                "this one needs a new folder made by `palpate study prepare`");
}

TEST_F(Folder, RemovesWhatAKilledPreparationLeftButNotTheFolderOfARunningOne) {
  const fs::path parent = study_.parent_path();
  fs::create_directories(parent / ".palpate-study-killed" / "study");
  write_output(parent / ".palpate-study-killed" / "study" / "sealed.json", "{}");
  fs::create_directories(parent / ".palpate-study-lively");
  fs::create_directories(parent / ".palpate-study-person" / "notes");
  const int alive = ::open((parent / ".palpate-study-lively").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(alive, LOCK_EX), 0);
  prepare();
  EXPECT_THAT(names_in(parent),
              UnorderedElementsAre("study", ".palpate-study-lively", ".palpate-study-person"));
  ::close(alive);
}

TEST_F(Folder, IsUnblindedOnceWithAReason) {
  prepare();
  StudyFolder opened = open_study(study_);
  EXPECT_EQ(error_of([&] { unblind_study(opened, " ", true); }), "--why: must be the reason, not empty");
  EXPECT_FALSE(open_study(study_).unblinded());
  unblind_study(opened, "all are done", true);
  EXPECT_TRUE(opened.unblinded());
  StudyFolder again = open_study(study_);
  ASSERT_TRUE(again.unblinded());
  EXPECT_EQ(again.unblinding->reason, "all are done");
  EXPECT_THAT(error_of([&] { unblind_study(again, "again", true); }),
              testing::AllOf(
                  StartsWith((study_ / "unblinded.json").string() + ": the study was unblinded already at 2"),
                  EndsWith(": all are done")));
}

TEST_F(Folder, IsNotUnblindedWhilePeopleAreUnfinished) {
  prepare();
  StudyFolder opened = open_study(study_);
  {
    LogWriter first(opened.log_of(opened.ids[0]), opened.log_key(opened.ids[0]));
    first.append(EventRecord{"2026", "withdrawn", {}});
    LogWriter second(opened.log_of(opened.ids[1]), opened.log_key(opened.ids[1]));
    second.append(EventRecord{"2026", "session", {{"session", "1"}}});
    second.append(EventRecord{"2026", "session-end", {{"session", "1"}}});
  }
  EXPECT_EQ(error_of([&] { unblind_study(opened, "done"); }),
            study_.string() + ": 1 of 3 participants are not finished (" + opened.ids[2] +
                "): nobody can be run blind after unblinding; --early ends the study for them");
  EXPECT_FALSE(open_study(study_).unblinded());
}

TEST_F(Folder, IsAsBlindAsBeforeAfterAnUnblindingThatFailed) {
  prepare();
  const pid_t child = fork();
  if (child == 0) {  // a limit of the file's size acts as a full disk
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10, 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    StudyFolder opened = open_study(study_);
    const std::string error = error_of([&] { unblind_study(opened, "done", true); });
    _exit(error == (study_ / "unblinded.json").string() + ": cannot be written: File too large" &&
                  !opened.unblinded()
              ? 0
              : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  StudyFolder opened = open_study(study_);
  EXPECT_FALSE(opened.unblinded());
  EXPECT_EQ(names_in(study_).size(), 6U) << "nothing is left";
  unblind_study(opened, "done", true);
  EXPECT_TRUE(open_study(study_).unblinded());
}

TEST_F(Folder, AnEmptyDamagedOrForgedUnblindingIsAnErrorThatSaysSo) {
  prepare();
  const std::string file = (study_ / "unblinded.json").string();
  const std::string error =
      file +
      ": is empty, damaged or not made with this study's sealed key, so the study is not "
      "unblinded: remove the file, and the study is blind";
  for (const std::string& bytes :
       {std::string(), std::string("{}"), std::string("{\"time\":\"2026\",\"reason\":\"x\",\"mac\":\"00\"}"),
        std::string(200'000, '[')}) {
    write_output(file, bytes);
    EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }), error) << bytes.substr(0, 30);
  }
  fs::remove(file);
  StudyFolder opened = open_study(study_);
  unblind_study(opened, "done", true);
  std::string changed = bytes_of(file);
  changed.replace(changed.find("\"done\""), 6, "\"gone\"");
  write_output(file, changed);
  EXPECT_THAT(error_of([&] { static_cast<void>(open_study(study_)); }),
              EndsWith("so nobody can read why the study was unblinded: restore the file"));
}

TEST_F(Folder, CannotBeBlindedAgain) {
  prepare();
  StudyFolder opened = open_study(study_);
  unblind_study(opened, "done", true);
  fs::remove(study_ / "unblinded.json");
  EXPECT_EQ(
      error_of([&] { static_cast<void>(open_study(study_)); }),
      (study_ / "unblinded.json").string() + ": is missing, though the study was unblinded (heads.txt)");
}

TEST_F(Folder, KeepsTheLogsAsTheyWereAtTheUnblinding) {
  prepare();
  StudyFolder opened = open_study(study_);
  const std::string id = opened.ids[0];
  LogWriter(opened.log_of(id), opened.log_key(id)).append(EventRecord{"2026", "note", {}});
  unblind_study(opened, "done", true);
  EXPECT_EQ(open_study(study_).read(id).events.size(), 1U);
  LogWriter(opened.log_of(id), opened.log_key(id)).append(EventRecord{"2026", "note", {}});
  EXPECT_EQ(
      error_of([&] { static_cast<void>(open_study(study_).read(id)); }),
      opened.log_of(id).string() + ": has 2 lines, had 1 when the study was unblinded (unblinded.json)");
  EXPECT_EQ(error_of([&] { require_blind(open_study(study_)); }),
            study_.string() + ": is unblinded, so nobody can be run blind; prepare another folder");
}

TEST_F(Folder, IsMarkedAsSimulated) {
  prepare();
  StudyFolder opened = open_study(study_);
  mark_simulated(opened);
  mark_simulated(opened);
  EXPECT_TRUE(opened.simulated);
  EXPECT_TRUE(open_study(study_).simulated);
}

TEST_F(Folder, SimulatedParticipantsCannotBecomePeople) {
  prepare();
  StudyFolder opened = open_study(study_);
  const std::string id = opened.ids[0];
  mark_simulated(opened);
  TrialRecord trial;
  trial.observer = "sr";
  LogWriter(opened.log_of(id), opened.log_key(id)).append(trial);
  EXPECT_EQ(open_study(study_).read(id).trials.size(), 1U);
  fs::remove(study_ / "simulated.json");
  EXPECT_EQ(
      error_of([&] { static_cast<void>(open_study(study_).read(id)); }),
      opened.log_of(id).string() +
          ": has trials of a simulated observer, but simulated.json is missing: one of them was removed "
          "or added");
  write_output(study_ / "simulated.json", "{}");
  EXPECT_THAT(error_of([&] { static_cast<void>(open_study(study_)); }),
              HasSubstr("simulated.json: is empty, damaged or not made with this study's sealed key"));
}

TEST_F(Folder, ALogOfOneParticipantIsNotTakenForThatOfAnother) {
  prepare();
  const StudyFolder opened = open_study(study_);
  LogWriter(opened.log_of(opened.ids[0]), opened.log_key(opened.ids[0]))
      .append(EventRecord{"2026", "note", {}});
  fs::copy_file(opened.log_of(opened.ids[0]), opened.log_of(opened.ids[1]));
  EXPECT_EQ(error_of([&] { static_cast<void>(opened.read(opened.ids[1])); }),
            opened.log_of(opened.ids[1]).string() + ":1: was changed: its mac does not fit");
}

// A cycle of links, whose error a privileged user gets, too.
TEST_F(Folder, ALogThatCannotBeLookedAtIsNoEmptyLog) {
  prepare();
  const StudyFolder opened = open_study(study_);
  const fs::path log = opened.log_of(opened.ids[0]);
  fs::create_symlink(log.filename(), log);
  EXPECT_EQ(error_of([&] { static_cast<void>(opened.read(opened.ids[0])); }),
            log.string() + ": cannot be looked at: Too many levels of symbolic links");
}

TEST_F(Folder, WithALockThatWasChangedIsRefusedBeforeAndAfterTheUnblinding) {
  prepare();
  StudyFolder opened = open_study(study_);
  const std::string lock = bytes_of(study_ / "lock.json");
  std::string changed = lock;  // the ids in another order
  changed.replace(changed.find(opened.ids[0]), 5, opened.ids[1]);
  changed.replace(changed.rfind(opened.ids[1]), 5, opened.ids[0]);
  const auto error = [&] {
    write_output(study_ / "lock.json", changed);
    const std::string found = error_of([&] { static_cast<void>(open_study(study_)); });
    write_output(study_ / "lock.json", lock);
    return found;
  };
  const std::string start = (study_ / "lock.json").string() + ": was changed after the study was prepared (";
  EXPECT_EQ(error(), start + "heads.txt)");
  unblind_study(opened, "done", true);
  EXPECT_EQ(error(), start + "unblinded.json)");
  EXPECT_TRUE(open_study(study_).unblinded());
}

TEST_F(Folder, WithALockThatNamesFilesElsewhereIsRefused) {
  prepare();
  const std::string lock = bytes_of(study_ / "lock.json");
  for (const char* name : {"../small.toml", "/etc/passwd", "scene/../../small.toml"}) {
    write_output(study_ / "lock.json", replaced(lock, "\"study.toml\"", "\"" + std::string(name) + "\""));
    EXPECT_EQ(error_of([&] { static_cast<void>(open_study(study_)); }),
              (study_ / "lock.json").string() + ": files: \"" + name +
                  "\": must be a path in the study's folder, without \"..\"");
  }
}

TEST(SceneOf, ABuiltInOrganHasTheStudysForceLimit) {
  const Study study = parse_study(kStudyText, "s.toml");
  const scene::Overrides request = scene_of(study);
  EXPECT_EQ(request.organ, "box");
  EXPECT_EQ(scene::load(request).safety.max_force, 6.0);
}

TEST(SceneOf, AnUnknownSceneNamesTheNearestOrgan) {
  Study study = parse_study(kStudyText, "s.toml");
  study.scene = "hart";
  EXPECT_THAT(
      error_of([&] { static_cast<void>(scene_of(study)); }),
      testing::AllOf(StartsWith("s.toml: study.scene = \"hart\": must be a scene file, relative to the "
                                "study file, or gallbladder, "),
                     EndsWith("did you mean heart?")));
}

}  // namespace
}  // namespace palpate::study
