#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <future>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "io/record/recording_writer.h"
#include "io/record/scene_json.h"
#include "io/record/test/sample_recording.h"
#include "io/system/clock.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::HasSubstr;

/// Number of ticks given to the recorder, shared with a child process.
class SharedCount final {
 public:
  SharedCount()
      : count_(new (::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))
                   std::atomic<std::uint64_t>(0)) {}
  ~SharedCount() { ::munmap(count_, 4096); }
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;
  std::atomic<std::uint64_t>& operator*() const { return *count_; }

 private:
  std::atomic<std::uint64_t>* count_;
};

constexpr std::uint64_t kTicksAChange = 7;

/// Tissue and noise at a tick; every kTicksAChange-th tick has an update.
haptics::ParameterUpdate sample_change(std::uint64_t tick) {
  haptics::ParameterUpdate change =
      haptics::parameter_update(sample_setup(1).tissue, {}, haptics::kTissueChanged);
  change.tick = tick;
  change.number = tick / kTicksAChange + 1;
  change.tissue.k1 = 10.0 + 1.0 / static_cast<double>(change.number);
  return change;
}

/// Records at 1 kHz in real time until it is killed.
[[noreturn]] void record_until_killed(const std::filesystem::path& file, std::size_t hands,
                                      std::atomic<std::uint64_t>& ticks) {
  Recorder recorder(file, sample_setup(hands), false);
  recorder.on_start(kStarted);
  const std::int64_t begin = monotonic_ns();
  for (std::uint64_t tick = 0;; ++tick) {
    sleep_until_ns(begin + static_cast<std::int64_t>(tick) * 1'000'000);
    if (tick % kTicksAChange == 0) recorder.on_update(sample_change(tick));
    for (std::uint32_t hand = 0; hand < hands; ++hand) recorder.on_row(sample_row(tick, hand));
    ticks.store(tick + 1);
  }
}

/// A recording whose process was killed after `ms` milliseconds. @return the number of ticks given to the
/// recorder until then
std::uint64_t record_and_kill(const std::filesystem::path& file, std::size_t hands, int ms) {
  const SharedCount ticks;
  const pid_t child = ::fork();
  if (child == 0) record_until_killed(file, hands, *ticks);
  while ((*ticks).load() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return (*ticks).load();
}

void expect_rows_from_the_start(const Recording& recording, std::size_t hands) {
  ASSERT_EQ(recording.rows.size() % hands, 0U);
  for (std::size_t i = 0; i < recording.rows.size(); ++i) {
    ASSERT_TRUE(same_bits(recording.rows[i], sample_row(i / hands, static_cast<std::uint32_t>(i % hands))))
        << i;
  }
}

/// Expects the updates of all ticks whose rows can be read.
void expect_all_changes(const Recording& recording, std::size_t hands) {
  const std::size_t ticks = recording.rows.size() / hands;
  ASSERT_GE(recording.changes.size(), (ticks + kTicksAChange - 1) / kTicksAChange);
  for (std::size_t i = 0; i < recording.changes.size(); ++i) {
    ASSERT_EQ(recording.changes[i], sample_change(i * kTicksAChange)) << i;
  }
}

class Killed : public ::testing::TestWithParam<std::pair<int, std::size_t>> {};

TEST_P(Killed, RecordingIsReadAndLacksAtMostTheLastSecond) {
  const auto [ms, hands] = GetParam();
  const TemporaryFolder folder;
  const std::uint64_t ticks = record_and_kill(folder / "a.h5", hands, ms);
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_FALSE(recording.facts.complete);
  EXPECT_EQ(recording.facts.started_unix_ns, kStarted);
  expect_rows_from_the_start(recording, hands);
  expect_all_changes(recording, hands);
  EXPECT_GE(recording.rows.size() / hands + 1000, ticks);
  EXPECT_LE(recording.rows.size() / hands, ticks);
}

TEST(Killed, OfflineRunLacksAtMostItsLastSimulatedSecond) {
  const TemporaryFolder folder;
  const SharedCount ticks;
  const pid_t child = ::fork();
  if (child == 0) {
    Recorder recorder(folder / "a.h5", sample_setup(1), true);
    recorder.on_start(kStarted);
    for (std::uint64_t tick = 0;; ++tick) {
      recorder.on_row(sample_row(tick, 0));
      (*ticks).store(tick + 1);
    }
  }
  while ((*ticks).load() < 20000) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  const Recording recording = read_recording(folder / "a.h5");
  expect_rows_from_the_start(recording, 1);
  EXPECT_GE(recording.rows.size() + 1000, (*ticks).load());
}

INSTANTIATE_TEST_SUITE_P(Moments, Killed,
                         ::testing::Values(std::pair{150, 1}, std::pair{201, 2}, std::pair{403, 1},
                                           std::pair{777, 3}, std::pair{1234, 1}, std::pair{1999, 2}));

TEST(Killed, RecordingIsRepairedWithTheSameRowsAndOpensPlainly) {
  const TemporaryFolder folder;
  (void)record_and_kill(folder / "a.h5", 2, 900);
  EXPECT_FALSE(opens_plainly(folder / "a.h5"));
  const std::size_t rows = read_recording(folder / "a.h5").rows.size();
  EXPECT_GT(rows, 0U);
  const RepairResult result = repair_recording(folder / "a.h5");
  EXPECT_TRUE(result.was_damaged);
  EXPECT_EQ(result.rows, rows);
  EXPECT_TRUE(opens_plainly(folder / "a.h5"));
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_EQ(recording.rows.size(), rows);
  EXPECT_EQ(recording.facts.started_unix_ns, kStarted);
  EXPECT_FALSE(recording.facts.complete);
  expect_rows_from_the_start(recording, 2);
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_FALSE(repair_recording(folder / "a.h5").was_damaged);
  expect_all_changes(read_recording(folder / "a.h5"), 2);
}

TEST(Repair, WholeRecordingIsLeftUntouched) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 5000, 1);
  const std::string before = contents(folder / "a.h5");
  const RepairResult result = repair_recording(folder / "a.h5");
  EXPECT_FALSE(result.was_damaged);
  EXPECT_EQ(result.rows, 5000U);
  EXPECT_EQ(contents(folder / "a.h5"), before);
}

/// Reads, repairs and reads again; no damage may cause anything but an InputError.
void expect_no_crash(const std::filesystem::path& file, std::size_t hands) {
  try {
    const Recording recording = read_recording(file);
    expect_rows_from_the_start(recording, hands);
    EXPECT_EQ(repair_recording(file).rows, recording.rows.size());
    EXPECT_TRUE(opens_plainly(file));
    EXPECT_EQ(read_recording(file).rows.size(), recording.rows.size());
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.string()));
  }
}

class Truncated : public ::testing::TestWithParam<bool> {};

TEST_P(Truncated, FileOfAnyLengthGivesItsFirstRowsOrAnInputError) {
  const bool killed = GetParam();
  const TemporaryFolder folder;
  if (killed) {
    (void)record_and_kill(folder / "whole.h5", 2, 1500);
  } else {
    record_sample(folder / "whole.h5", 1500, 2);
  }
  const std::string bytes = contents(folder / "whole.h5");
  std::mt19937 random(5);
  std::uniform_int_distribution<std::size_t> anywhere(0, bytes.size());
  std::uniform_int_distribution<std::size_t> early(0, 20000);
  for (int i = 0; i < 120; ++i) {
    const std::size_t length = i % 2 == 0 ? anywhere(random) : early(random);
    SCOPED_TRACE(length);
    std::ofstream(folder / "a.h5", std::ios::binary) << bytes.substr(0, length);
    expect_no_crash(folder / "a.h5", 2);
  }
}

INSTANTIATE_TEST_SUITE_P(KilledOrClosed, Truncated, ::testing::Values(true, false));

TEST(Truncated, HalfAFileStillGivesRows) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 5000, 1);
  std::filesystem::resize_file(folder / "a.h5", std::filesystem::file_size(folder / "a.h5") / 2);
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_GE(recording.rows.size(), 2000U);
  EXPECT_FALSE(recording.facts.complete);
  expect_rows_from_the_start(recording, 1);
}

TEST(Damaged, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  record_sample(folder / "whole.h5", 50, 1);
  const std::string bytes = contents(folder / "whole.h5");
  std::mt19937 random(6);
  std::uniform_int_distribution<std::size_t> anywhere(8, 20000);
  for (int i = 0; i < 200; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged.at(anywhere(random)) = static_cast<char>(random());
    std::ofstream(folder / "a.h5", std::ios::binary) << damaged;
    try {
      (void)read_recording(folder / "a.h5");
    } catch (const InputError&) {
      continue;
    }
  }
}

/// In a child process: the recorder may write at most `limit` bytes to a file. Returns 0 when its failure is
/// reported during the run, and again by finish().
int record_with_limit(const std::filesystem::path& file, rlim_t limit) {
  std::signal(SIGXFSZ, SIG_IGN);
  std::promise<std::string> reported;
  Recorder recorder(file, sample_setup(1), true, [&](const std::string& what) { reported.set_value(what); });
  recorder.on_start(kStarted);
  for (std::uint64_t tick = 0; tick < 2000; ++tick) recorder.on_row(sample_row(tick, 0));
  const rlimit bounds{limit, limit};
  ::setrlimit(RLIMIT_FSIZE, &bounds);
  for (std::uint64_t tick = 2000; tick < 40000; ++tick) recorder.on_row(sample_row(tick, 0));
  const std::string failure = reported.get_future().get();
  for (std::uint64_t tick = 40000; tick < 41000; ++tick) recorder.on_row(sample_row(tick, 0));
  try {
    recorder.finish({});
  } catch (const InputError& error) {
    const bool named = failure.find(file.string() + ": the recording ends after its first ") == 0;
    return named && failure == error.what() ? 0 : 2;
  }
  return 1;
}

TEST(DiskFull, IsReportedAtOnceAndWhatWasWrittenStaysReadable) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(record_with_limit(folder / "a.h5", 5'000'000));
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_GE(recording.rows.size(), 2000U);
  EXPECT_LT(recording.rows.size(), 40000U);
  expect_rows_from_the_start(recording, 1);
  EXPECT_TRUE(repair_recording(folder / "a.h5").was_damaged);
  EXPECT_TRUE(opens_plainly(folder / "a.h5"));
}

/// The offset in a file of row `row` of /ticks, which begins a chunk.
haddr_t place_of_chunk(const std::filesystem::path& file, hsize_t row) {
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t ticks = H5Dopen2(id, "ticks", H5P_DEFAULT);
  unsigned filters = 0;
  haddr_t place = HADDR_UNDEF;
  hsize_t bytes = 0;
  EXPECT_GE(H5Dget_chunk_info_by_coord(ticks, &row, &filters, &place, &bytes), 0);
  H5Dclose(ticks);
  H5Fclose(id);
  return place;
}

/// Rewrites the dataset of rows without checksums, as in older recordings.
void remove_checksums(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t ticks = H5Dopen2(file, "ticks", H5P_DEFAULT);
  const hid_t type = H5Dget_type(ticks);
  const hid_t space = H5Dget_space(ticks);
  const hid_t how = H5Dget_create_plist(ticks);
  EXPECT_GE(H5Premove_filter(how, H5Z_FILTER_FLETCHER32), 0);
  std::vector<char> rows(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type));
  H5Dread(ticks, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  H5Dclose(ticks);
  H5Ldelete(file, "ticks", H5P_DEFAULT);
  const hid_t plain = H5Dcreate2(file, "ticks", type, space, H5P_DEFAULT, how, H5P_DEFAULT);
  EXPECT_GE(H5Dwrite(plain, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), 0);
  H5Dclose(plain);
  H5Pclose(how);
  H5Sclose(space);
  H5Tclose(type);
  H5Fclose(file);
}

TEST(DamagedRecording, OneOfBeforeThereWereChecksumsOpensWithAllRows) {
  constexpr std::uint64_t kRows = 2 * RecordingWriter::kChunkRows + 5;
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", kRows, 1);
  remove_checksums(folder / "a.h5");
  EXPECT_EQ(read_recording(folder / "a.h5").rows.size(), kRows);
}

TEST(DamagedRecording, AFlippedBitInARowIsReportedAndRepairKeepsTheRowsBeforeItsChunk) {
  constexpr std::uint64_t kChunk = RecordingWriter::kChunkRows;
  for (const std::size_t member : {offsetof(haptics::TickRow, force), sizeof(haptics::TickRow) / 2}) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder / "a.h5";
    record_sample(file, 3 * kChunk, 1);
    const haddr_t place = place_of_chunk(file, kChunk) + 7 * sizeof(haptics::TickRow) + member;
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekg(static_cast<std::streamoff>(place));
    const auto flipped = static_cast<char>(bytes.get() ^ 0x10);
    bytes.seekp(static_cast<std::streamoff>(place));
    bytes.put(flipped);
    bytes.close();
    EXPECT_THAT([&] { (void)read_recording(file); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr(
                    "rows from " + std::to_string(kChunk) + " on cannot be read: they are damaged")));
    const RepairResult repaired = repair_recording(file);
    EXPECT_TRUE(repaired.was_damaged);
    EXPECT_EQ(repaired.rows, kChunk);
    EXPECT_EQ(read_recording(file).rows.size(), kChunk);
  }
}

/// Flips the lowest bit of the byte at offset `place` of a dataset's values.
void flip_bit(const std::filesystem::path& file, const char* dataset, std::size_t place) {
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t set = H5Dopen2(id, dataset, H5P_DEFAULT);
  const auto at = static_cast<std::streamoff>(H5Dget_offset(set) + place);
  H5Dclose(set);
  H5Fclose(id);
  std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
  bytes.seekg(at);
  const auto flipped = static_cast<char>(bytes.get() ^ 1);
  bytes.seekp(at);
  bytes.put(flipped);
}

constexpr std::array<const char*, 4> kHashed = {"/scene", "/organ/vertices", "/organ/triangles",
                                                "/tools/0/parts/1/vertices"};

TEST(DamagedRecording, AFlippedBitInSceneOrMeshIsRefusedWithTheNameOfWhatIsDamaged) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  for (const char* dataset : kHashed) {
    record_sample(file, 10, 1);
    const std::string scene = scene_to_json(sample_setup(1));
    const bool in_scene = dataset == kHashed[0];
    flip_bit(file, dataset, in_scene ? scene.find("soft") : 0);
    EXPECT_THAT([&] { (void)read_recording(file); },
                testing::ThrowsMessage<InputError>(
                    testing::HasSubstr(std::string(dataset) + (dataset == kHashed[2] ? "" : " is damaged"))))
        << dataset;
  }
}

TEST(DamagedRecording, OneOfBeforeThereWereContentHashesOpens) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  record_sample(file, 10, 1);
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const char* dataset : kHashed) {
    EXPECT_GE(H5Adelete_by_name(id, dataset, "content_hash", H5P_DEFAULT), 0) << dataset;
  }
  H5Fclose(id);
  EXPECT_EQ(read_recording(file).rows.size(), 10U);
}

}  // namespace
}  // namespace palpate::record
