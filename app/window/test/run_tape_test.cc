// Recordings that begin during a run. They need no display.
#include "app/run_tape.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/session.h"
#include "palpate/tissue.h"

namespace palpate::app {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// Keeps the rows and updates of a run.
class Collector final : public haptics::TickObserver {
 public:
  void on_start(std::int64_t started_unix_ns) noexcept override { started = started_unix_ns; }
  void on_update(const haptics::ParameterUpdate& update) noexcept override { updates.push_back(update); }
  void on_row(const haptics::TickRow& row) noexcept override { rows.push_back(row); }

  std::int64_t started = 0;
  std::vector<haptics::TickRow> rows;
  std::vector<haptics::ParameterUpdate> updates;
};

/// A press of a ball, with a stiffer tissue from its first tick on.
class RunTapeTest : public testing::Test {
 protected:
  static constexpr std::size_t kTicks = 1500;

  RunTapeTest() : session_(scene(), {.duration_s = 1.5}) {
    model::TissueParameters stiff = model::tissue_preset("liver");
    stiff.k1 *= 2.0;
    (void)session_.updates().offer(stiff);
    result_ = session_.run({.offline = true, .keep_fault = false}, {&run_});
  }
  static scene::Scene scene() {
    scene::Overrides request;
    request.organ = "ball";
    request.tissue = "liver";
    request.tools = {"sphere:5"};
    return scene::load(request);
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void add(RunTape& tape, std::size_t from, std::size_t to) const {
    for (std::size_t i = from; i < to; ++i) tape.add(run_.rows[i]);
  }
  void add_updates(RunTape& tape) const {
    for (const haptics::ParameterUpdate& update : run_.updates) tape.add(update);
  }
  [[nodiscard]] const session::Session& session() const { return session_; }
  [[nodiscard]] const Collector& run() const { return run_; }
  [[nodiscard]] const session::RunResult& result() const { return result_; }

 private:
  test::TemporaryFolder folder_;
  session::Session session_;
  Collector run_;
  session::RunResult result_;
};

TEST_F(RunTapeTest, ARecordingThatBeginsLateHasTheRunFromItsFirstTick) {
  ASSERT_EQ(run().rows.size(), kTicks);
  ASSERT_EQ(run().updates.size(), 1U);
  RunTape tape(session().scene());
  add_updates(tape);
  add(tape, 0, 1100);  // more than one block
  EXPECT_FALSE(tape.writing());
  tape.begin(file("late.h5"), run().started);
  EXPECT_TRUE(tape.writing());
  EXPECT_FALSE(tape.feed(100)) << "a frame passes on a part";
  EXPECT_TRUE(tape.feed(1000));
  add(tape, 1100, kTicks);
  tape.end(&result().loop);
  EXPECT_FALSE(tape.writing());
  const record::Recording read = record::read_recording(file("late.h5"));
  EXPECT_TRUE(read.facts.complete);
  EXPECT_EQ(read.facts.started_unix_ns, run().started);
  ASSERT_EQ(read.rows.size(), kTicks);
  EXPECT_EQ(read.rows.front().tick, 0U);
  EXPECT_EQ(read.changes.size(), 1U);
  EXPECT_EQ(record::hash_rows(read.rows), record::hash_rows(run().rows));
  EXPECT_EQ(record::replay(read).rows_different, 0U);
}

TEST_F(RunTapeTest, ARecordingThatEndsBeforeItsRunIsCompleteAndSaysSo) {
  RunTape tape(session().scene());
  add_updates(tape);
  add(tape, 0, 200);
  tape.begin(file("first.h5"), run().started);
  tape.end(nullptr);
  add(tape, 200, 300);
  tape.begin(file("second.h5"), run().started);
  tape.end(nullptr);
  const record::Recording first = record::read_recording(file("first.h5"));
  EXPECT_TRUE(first.facts.complete);
  EXPECT_EQ(first.rows.size(), 200U);
  EXPECT_THAT(first.facts.remarks, Contains(HasSubstr("ended before its run")));
  const record::Recording second = record::read_recording(file("second.h5"));
  EXPECT_EQ(second.rows.size(), 300U);
  EXPECT_EQ(record::replay(second).rows_different, 0U);
}

TEST_F(RunTapeTest, ARunThatIsTooLongIsNotRecordedWithoutItsBeginning) {
  RunTape tape(session().scene(), 100 * sizeof(haptics::TickRow));
  add(tape, 0, 101);
  try {
    tape.begin(file("long.h5"), run().started);
    FAIL() << "a recording needs all rows";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("only the first"));
  }
  EXPECT_FALSE(std::filesystem::exists(file("long.h5")));
}

TEST_F(RunTapeTest, MissingRowsEndTheRecordingBeforeThemInWords) {
  RunTape tape(session().scene());
  add_updates(tape);
  add(tape, 0, 100);
  tape.begin(file("gap.h5"), run().started);
  add(tape, 101, 200);
  EXPECT_THAT(tape.failure(), HasSubstr("rows after 0.1 s are missing"));
  EXPECT_THROW(tape.end(nullptr), InputError);
  const record::Recording read = record::read_recording(file("gap.h5"));
  EXPECT_EQ(read.rows.size(), 100U);
  EXPECT_EQ(record::replay(read).rows_different, 0U);
}

TEST_F(RunTapeTest, AFreeNameNeverIsThatOfAFile) {
  EXPECT_EQ(free_name(file("search.h5"), true), file("search.h5"));
  std::ofstream(file("search.h5")) << "1";
  EXPECT_EQ(free_name(file("search.h5"), true), file("search-2.h5"));
  std::ofstream(file("search-2.h5")) << "2";
  EXPECT_EQ(free_name(file("search.h5"), false), file("search-3.h5"));
}

}  // namespace
}  // namespace palpate::app
