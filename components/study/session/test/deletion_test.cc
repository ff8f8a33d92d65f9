#include "study/session/deletion.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/output_file.h"
#include "io/system/temporary.h"

#include "study/session/analysis.h"
#include "study/session/test/study_text.h"
#include "study/session/verify.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kSecret = "a note that only one person wrote";

/// A study of three people, of whom the first two have a log, recordings and other files.
class DeletedPerson : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path file = folder_.path() / "small.toml";
    write_output(file, replaced(kStudyText, "scene = \"box\"", "scene = \"box\""));
    prepare_study(file, folder_.path() / "study", 3);
    study_ = open_study(folder_.path() / "study");
    for (int person = 0; person < 2; ++person) write_person(study_.ids[static_cast<std::size_t>(person)]);
  }

  void write_person(const std::string& id) const {
    LogWriter log(study_.log_of(id), study_.log_key(id));
    for (const char* event : {"consent", "session", "note"}) {
      log.append(EventRecord{utc_now(), event, {{"session", "1"}, {"text", kSecret}, {"answer", "yes"}}});
    }
    for (int block = 1; block <= 2; ++block) write_output(study_.recording_of(id, 1, block), kSecret);
    write_output(cut_lines_of(study_.log_of(id)), kSecret);
    write_output(study_.folder / (id + "-status.txt"), kSecret);
  }
  [[nodiscard]] const std::string& id(std::size_t person = 0) const { return study_.ids[person]; }
  /// Whether a file of the study has a text.
  [[nodiscard]] int files_with(const std::string& text) const {
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(study_.folder)) {
      if (entry.is_regular_file() && bytes_of(entry.path()).find(text) != std::string::npos) ++files;
    }
    return files;
  }
  [[nodiscard]] std::string verify_error() const {
    return error_of([&] {
      VerifyCounts counts;
      const StudyFolder study = open_study(study_.folder);
      static_cast<void>(verify_folder(study));
      for (const std::string& one : study.ids) verify_participant(study, one, {}, counts);
    });
  }

  ScratchFolder folder_{"palpate-deletion"};
  StudyFolder study_;
};

TEST_F(DeletedPerson, LeavesNoByteOfTheDataAndAChainThatSaysSo) {
  ASSERT_EQ(files_with(kSecret), 10);
  EXPECT_EQ(files_of_person(study_, id()).size(), 5U);
  const Deletion deletion = delete_person(study_, id(), "asked by letter");
  EXPECT_EQ(files_with(kSecret), 5) << "those of the other person";
  EXPECT_TRUE(files_of_person(study_, id()).empty());
  EXPECT_EQ(deletion.before.lines, 3U);
  const StudyFolder again = open_study(study_.folder);
  EXPECT_EQ(again.ids, study_.ids);
  EXPECT_EQ(again.read(id()).deletion(), deletion);
  EXPECT_EQ(again.read(id(1)).lines(), 3U);
  EXPECT_EQ(verify_error(), "no error");
  VerifyCounts counts;
  verify_participant(again, id(), {}, counts);
  EXPECT_THAT(deletions_text(counts.deleted),
              StartsWith("1 person's data deleted on request (" + id() + ", 2"));
  EXPECT_THAT(deletions_text(counts.deleted), EndsWith(": asked by letter)"));
  EXPECT_EQ(deletions_text({}), "");
}

TEST_F(DeletedPerson, IsCountedByTheAnalysisAndInNoOtherNumber) {
  delete_person(study_, id(), "asked");
  const std::vector<Participant> people = read_people(study_);
  const StudyAnalysis analysis = analyse(study_.study, people, study_.key, false);
  EXPECT_EQ(analysis.deleted.size(), 1U);
  EXPECT_EQ(analysis.consented, 1);
  EXPECT_EQ(analysis.withdrawn + analysis.excluded, 0);
  EXPECT_TRUE(analysis.people.empty());
  EXPECT_THAT(unfinished_people(study_), ElementsAre(id(1), id(2)));
}

TEST_F(DeletedPerson, GetsNoLineAndNobodyElseGetsTheId) {
  delete_person(study_, id(), "asked");
  EXPECT_THAT(error_of([&] { LogWriter(study_.log_of(id()), study_.log_key(id())); }),
              HasSubstr("the data of " + id() + " were deleted on 2"));
  EXPECT_EQ(verify_error(), "no error");
}

// A process killed after each step: the new log with the old head, and all files but some.
TEST_F(DeletedPerson, IsFinishedByASecondCallAfterACrash) {
  const std::string old_heads = bytes_of(study_.folder / LogHeads::kName);
  const std::string old_log = bytes_of(study_.log_of(id()));
  delete_person(study_, id(), "asked");
  write_output(study_.folder / LogHeads::kName, old_heads);
  EXPECT_TRUE(study_.read(id()).deletion());
  EXPECT_EQ(verify_error(), "no error");
  write_output(study_.recording_of(id(), 1, 2), kSecret);
  EXPECT_THAT(verify_error(), EndsWith("-s1-b02.h5: is there, though the data of " + id() +
                                       " were deleted (1 file of them left): `palpate study delete` again "
                                       "removes it"));
  const Deletion again = delete_person(study_, id(), "another reason");
  EXPECT_EQ(again.reason, "asked") << "the first call's";
  EXPECT_NE(bytes_of(study_.folder / LogHeads::kName), old_heads);
  EXPECT_EQ(verify_error(), "no error");
  EXPECT_EQ(files_with(kSecret), 5);
  write_output(study_.log_of(id()), old_log);
  EXPECT_THAT(verify_error(), HasSubstr("is not the line that was written")) << "the old log comes back";
}

TEST_F(DeletedPerson, CanNeitherBeInventedNorUndoneByRemovingTheLine) {
  const fs::path log = study_.log_of(id());
  delete_person(study_, id(1), "asked");
  write_output(log, bytes_of(study_.log_of(id(1))));
  EXPECT_THAT(verify_error(), HasSubstr(id() + ".jsonl:1: was changed: its mac does not fit"));
  fs::remove(study_.log_of(id(1)));
  write_person(id(2));
  EXPECT_THAT(error_of([&] { static_cast<void>(study_.read(id(1))); }),
              HasSubstr(": has 0 lines, must have 1"));
}

TEST_F(DeletedPerson, MayBeDeletedAfterUnblinding) {
  delete_person(study_, id(), "before");
  unblind_study(study_, "done", true);
  EXPECT_EQ(verify_error(), "no error");
  delete_person(study_, id(1), "after");
  EXPECT_EQ(verify_error(), "no error");
  EXPECT_EQ(deletions_of(read_people(open_study(study_.folder))).size(), 2U);
  EXPECT_THAT(deletions_text(deletions_of(read_people(study_))), StartsWith("2 people's data deleted"));
}

TEST_F(DeletedPerson, OfADamagedLogIsDeletedWithANoteOfTheDamage) {
  write_output(study_.log_of(id()), "{}\n");
  EXPECT_TRUE(delete_person(study_, id(), "asked").damaged);
  EXPECT_EQ(verify_error(), "no error");
  EXPECT_EQ(files_with(kSecret), 5);
  EXPECT_THAT(deletions_text(deletions_of(read_people(study_))),
              EndsWith("asked; the log was damaged before)"));
}

TEST_F(DeletedPerson, NeedsAReasonDataAndNoRunningSession) {
  EXPECT_EQ(error_of([&] { delete_person(study_, id(), " "); }), "--why: must be the reason, not empty");
  EXPECT_THAT(error_of([&] { delete_person(study_, id(2), "asked"); }),
              EndsWith("study: there are no data of " + id(2)));
  const LogWriter session(study_.log_of(id(1)), study_.log_key(id(1)));
  EXPECT_THAT(error_of([&] { delete_person(study_, id(), "asked"); }), HasSubstr("a session is running"));
  EXPECT_EQ(files_with(kSecret), 10);
}

}  // namespace
}  // namespace palpate::study
