#include "io/record/csv_recorder.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/record/test/sample_recording.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A run of 700 ticks of two hands with one parameter update, recorded to `file`.
Recording recorded_run(const std::filesystem::path& file, bool waits) {
  Recording run;
  haptics::ParameterUpdate update;
  update.tick = 300;
  update.what = haptics::kNoiseChanged;
  update.noise.gain = 1e-4;
  CsvRecorder recorder(file, sample_setup(2), waits);
  for (std::uint64_t tick = 0; tick < 700; ++tick) {
    if (tick == update.tick) recorder.on_update(update);
    for (const std::uint32_t hand : {0U, 1U}) {
      run.rows.push_back(sample_row(tick, hand));
      recorder.on_row(run.rows.back());
    }
  }
  recorder.finish({});
  run.changes = {update};
  return run;
}

TEST(CsvRecorder, WritesTheBytesThatAnExportOfTheRunWrites) {
  const TemporaryFolder folder;
  for (const bool waits : {false, true}) {
    const Recording run = recorded_run(folder / "run.csv", waits);
    export_csv(run, folder / "exported.csv");
    export_changes_csv(run, folder / "exported-changes.csv");
    EXPECT_EQ(contents(folder / "run.csv"), contents(folder / "exported.csv"));
    EXPECT_EQ(contents(folder / "run-changes.csv"), contents(folder / "exported-changes.csv"));
  }
}

TEST(CsvRecorder, WithoutUpdatesThereIsOneFile) {
  const TemporaryFolder folder;
  CsvRecorder recorder(folder / "run.csv", sample_setup(1), true);
  recorder.on_row(sample_row(0, 0));
  recorder.finish({});
  EXPECT_TRUE(std::filesystem::exists(folder / "run.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run-changes.csv"));
}

TEST(CsvRecorder, NamesTheFileThatCannotBeMade) {
  const TemporaryFolder folder;
  try {
    const CsvRecorder recorder(folder / "missing/run.csv", sample_setup(1), true);
    FAIL() << "the folder does not exist";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing/run.csv: the recording cannot be made: "));
  }
}

TEST(CsvRecorder, TheNameDecidesOnTheFormat) {
  const TemporaryFolder folder;
  for (const char* name : {"run.csv", "run.h5"}) {
    const std::unique_ptr<RunRecorder> recorder = make_recorder(folder / name, sample_setup(1), true);
    recorder->on_start(1);
    recorder->on_row(sample_row(0, 0));
    recorder->finish({});
  }
  EXPECT_THAT(contents(folder / "run.csv"), StartsWith("tick,time_s,"));
  EXPECT_EQ(read_recording(folder / "run.h5").rows.size(), 1U);
}

}  // namespace
}  // namespace palpate::record
