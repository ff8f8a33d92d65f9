#include <filesystem>
#include <fstream>
#include <functional>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/record/hdf5_handle.h"
#include "io/record/recording_writer.h"
#include "io/record/test/sample_recording.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string message_for(const std::filesystem::path& file) {
  try {
    (void)read_recording(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A valid recording of 10 ticks, changed by `change`.
std::filesystem::path changed_file(const TemporaryFolder& folder, const std::function<void(hid_t)>& change) {
  record_sample(folder / "a.h5", 10, 1);
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  return folder / "a.h5";
}

TEST(ForeignFile, MissingFileIsNamed) {
  const TemporaryFolder folder;
  const std::string file = (folder / "none.h5").string();
  EXPECT_THAT(message_for(file), AllOf(StartsWith(file), HasSubstr("there is no such file")));
}

TEST(ForeignFile, FolderTextAndEmptyFileAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_for(folder / "."), HasSubstr("is a folder, must be a palpate recording"));
  std::ofstream(folder / "text") << "tick,time_s\n0,0\n";
  EXPECT_THAT(message_for(folder / "text"), HasSubstr("not an HDF5 file"));
  std::ofstream(folder / "empty") << "";
  EXPECT_THAT(message_for(folder / "empty"), HasSubstr("not an HDF5 file"));
}

TEST(ForeignFile, ARecordingOpenForWritingElsewhereIsNotCalledDamaged) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 10, 1);
  const std::string file = (folder / "a.h5").string();
  const int other = ::open(file.c_str(), O_RDWR);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);  // as HDF5 locks what it opens for writing
  EXPECT_THAT(message_for(file), AllOf(StartsWith(file), HasSubstr("is open in another program")));
  EXPECT_THROW((void)repair_recording(file), InputError);
  ::close(other);
  EXPECT_EQ(message_for(file), "no error");
}

TEST(ForeignFile, ARecordingMarkedAsOpenForWritingIsNotCalledDamaged) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 10, 1);
  const hid_t id = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(id, 0);
  std::filesystem::copy_file(folder / "a.h5", folder / "b.h5");  // while it is open
  H5Fclose(id);
  EXPECT_THAT(message_for(folder / "b.h5"), HasSubstr("is marked as open for writing"));
}

TEST(ForeignFile, AFileOfAnotherKindIsNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "solid a\nfacet normal 0 0 1\n";
  EXPECT_THAT(
      message_for(folder / "a.h5"),
      HasSubstr("is a mesh (text STL), must be a palpate recording; palpate inspect, --organ and --tool"));
}

TEST(ForeignFile, AFifoIsRefusedWithoutWaiting) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(message_for(folder / "fifo"), HasSubstr("is a FIFO, must be a palpate recording"));
  EXPECT_THROW((void)repair_recording(folder / "fifo"), InputError);
}

TEST(ForeignFile, OtherHdf5FileIsRefused) {
  const TemporaryFolder folder;
  const std::string file = (folder / "other.h5").string();
  H5Fclose(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(message_for(file),
              AllOf(StartsWith(file), HasSubstr("not a palpate recording: no attribute format")));
  EXPECT_THROW((void)repair_recording(file), InputError);
}

TEST(ForeignFile, RecordingWithoutTicksOrSceneOrMeshSaysWhatIsMissing) {
  for (const std::string name : {"/ticks", "/scene", "/organ/vertices", "/tools/0/parts/1", "/organ"}) {
    const TemporaryFolder folder;
    const std::filesystem::path file =
        changed_file(folder, [&](hid_t id) { H5Ldelete(id, name.c_str(), H5P_DEFAULT); });
    EXPECT_THAT(message_for(file), HasSubstr("not a palpate recording: no " + name));
  }
}

TEST(ForeignFile, ARecordingThatLeadsToAnotherFileIsRefused) {
  const TemporaryFolder folder;
  record_sample(folder / "b.h5", 10, 1);
  for (const std::string name : {"/ticks", "/organ", "/organ/vertices"}) {
    const std::filesystem::path file = changed_file(folder, [&](hid_t id) {
      H5Ldelete(id, name.c_str(), H5P_DEFAULT);
      H5Lcreate_external("b.h5", name.c_str(), id, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    });
    EXPECT_THAT(message_for(file), HasSubstr("not a palpate recording: no " + name));
  }
}

TEST(ForeignFile, ADatasetWhoseValuesAreInAnotherFileIsRefused) {
  const TemporaryFolder folder;
  const std::string secret = (folder / "secret").string();
  std::ofstream(secret) << std::string(100'000, 'x');
  const std::filesystem::path file = changed_file(folder, [&](hid_t id) {
    const hid_t before = H5Dopen2(id, "/organ/triangles", H5P_DEFAULT);
    const hid_t space = H5Dget_space(before);
    const hid_t type = H5Dget_type(before);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(properties, secret.c_str(), 0, H5F_UNLIMITED);
    H5Dclose(before);
    H5Ldelete(id, "/organ/triangles", H5P_DEFAULT);
    H5Dclose(H5Dcreate2(id, "/organ/triangles", type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Tclose(type);
    H5Sclose(space);
  });
  EXPECT_THAT(message_for(file),
              HasSubstr("triangles is kept in another file, must be in the recording itself"));
}

TEST(ForeignFile, FormatVersionOfTheFutureIsRefused) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) { hdf5::rewrite_attribute(id, "format_version", 2); });
  EXPECT_THAT(message_for(file), HasSubstr("format version 2"));
}

TEST(ForeignFile, TicksWithoutAColumnAreRefusedWithItsName) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) {
    H5Ldelete(id, "/ticks", H5P_DEFAULT);
    const hid_t type = H5Tcreate(H5T_COMPOUND, 8);
    H5Tinsert(type, "tick", 0, H5T_NATIVE_UINT64);
    const hsize_t rows = 4;
    H5Dclose(H5Dcreate2(id, "/ticks", type, H5Screate_simple(1, &rows, nullptr), H5P_DEFAULT, H5P_DEFAULT,
                        H5P_DEFAULT));
  });
  EXPECT_THAT(message_for(file), HasSubstr("no column time_s"));
}

TEST(ForeignFile, TriangleWithAnIndexOutOfRangeIsRefused) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) {
    const std::int32_t wrong[4][3] = {{0, 2, 1}, {0, 1, 4}, {0, 3, 2}, {1, 2, 3}};
    const hid_t set = H5Dopen2(id, "/organ/triangles", H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, wrong);
    H5Dclose(set);
  });
  EXPECT_THAT(message_for(file), HasSubstr("/organ/triangles has index 4, want 0 to 3"));
}

TEST(ForeignFile, HugeClaimedSizesAreRefusedOrIgnoredWithoutTakingMemory) {
  const TemporaryFolder folder;
  const auto mesh = changed_file(folder, [](hid_t id) {
    H5Ldelete(id, "/organ/vertices", H5P_DEFAULT);
    const hsize_t size[2] = {hsize_t{1} << 50, 3};
    const hsize_t chunk[2] = {1024, 3};
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 2, chunk);
    H5Dclose(H5Dcreate2(id, "/organ/vertices", H5T_NATIVE_DOUBLE, H5Screate_simple(2, size, nullptr),
                        H5P_DEFAULT, properties, H5P_DEFAULT));
  });
  EXPECT_THAT(message_for(mesh), HasSubstr("more rows than the file can hold"));
  const auto ticks = changed_file(folder, [](hid_t id) {
    H5Ldelete(id, "/run/rows", H5P_DEFAULT);  // as an older recording, which does not have this number
    const hsize_t rows = hsize_t{1} << 50;
    const hid_t set = H5Dopen2(id, "/ticks", H5P_DEFAULT);
    H5Dset_extent(set, &rows);
    H5Dclose(set);
  });
  EXPECT_THAT(message_for(ticks), HasSubstr("row 10 of /ticks is out of order"));
}

TEST(ForeignFile, RowsOutOfOrderInACompleteRecordingAreRefused) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) {
    const hid_t set = H5Dopen2(id, "/ticks", H5P_DEFAULT);
    std::vector<haptics::TickRow> rows(10);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = sample_row(i == 6 ? 2 : i, 0);
    H5Dwrite(set, tick_row_type().id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
    H5Dclose(set);
  });
  EXPECT_THAT(message_for(file), HasSubstr("row 6 of /ticks is out of order"));
}

/// Replaces the rows of a recording of 10 ticks by `rows`.
void write_rows(hid_t file, const std::vector<haptics::TickRow>& rows) {
  const hid_t set = H5Dopen2(file, "/ticks", H5P_DEFAULT);
  H5Dwrite(set, tick_row_type().id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  H5Dclose(set);
}

TEST(ForeignFile, ARowWithAPhaseOrFaultThatDoesNotExistIsRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&folder](std::uint32_t haptics::TickRow::*number, std::uint32_t value) {
    return message_for(changed_file(folder, [&](hid_t id) {
      std::vector<haptics::TickRow> rows(10);
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = sample_row(i, 0);
      rows[4].*number = value;
      write_rows(id, rows);
    }));
  };
  EXPECT_THAT(refusal(&haptics::TickRow::phase, 4), HasSubstr("row 4 of /ticks has the phase 4"));
  EXPECT_THAT(refusal(&haptics::TickRow::fault, 200), HasSubstr("row 4 of /ticks has the fault 200"));
  EXPECT_THAT(refusal(&haptics::TickRow::device_fault, 257),
              HasSubstr("row 4 of /ticks has the device_fault 257"))
      << "not taken for fault 1";
  EXPECT_EQ(refusal(&haptics::TickRow::fault, 5), "no error");
}

void set_rows(hid_t file, hsize_t count) {
  const hid_t set = H5Dopen2(file, "/ticks", H5P_DEFAULT);
  H5Dset_extent(set, &count);
  H5Dclose(set);
}

TEST(ForeignFile, ACompleteRecordingWithFewerRowsThanItsRunWroteIsRefusedUntilItIsRepaired) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) { set_rows(id, 1); });
  EXPECT_THAT(message_for(file), HasSubstr("/ticks has 1 row, /run says 10: palpate repair keeps"));
  const RepairResult repaired = repair_recording(file);
  EXPECT_TRUE(repaired.was_damaged);
  EXPECT_EQ(repaired.rows, 1U);
  const Recording recording = read_recording(file);
  EXPECT_EQ(recording.rows.size(), 1U);
  EXPECT_FALSE(recording.facts.complete) << "rows are missing, and it says so";
}

TEST(ForeignFile, AnOlderRecordingThatDoesNotSayHowManyRowsItHasIsRead) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) { H5Ldelete(id, "/run/rows", H5P_DEFAULT); });
  EXPECT_EQ(message_for(file), "no error");
}

TEST(ForeignFile, ANegativeCountOfARunIsRefused) {
  const TemporaryFolder folder;
  const auto file = changed_file(folder, [](hid_t id) {
    const std::int64_t wrong = -1;
    const hid_t set = H5Dopen2(id, "/run/watchdog_stops", H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &wrong);
    H5Dclose(set);
  });
  EXPECT_THAT(message_for(file), HasSubstr("/run/watchdog_stops is -1, want at least 0"));
}

TEST(ForeignFile, BadSceneIsRefusedWithTheFilesName) {
  const TemporaryFolder folder;
  scene::Scene scene = sample_setup(1);
  scene.rate_Hz = 0.0;
  {
    Recorder recorder(folder / "a.h5", scene, true);
    recorder.on_start(0);
    recorder.finish({});
  }
  EXPECT_THAT(message_for(folder / "a.h5"),
              AllOf(HasSubstr("a.h5"), HasSubstr("rate_Hz = 0.0: must be a number from 100 to 20000")));
}

}  // namespace
}  // namespace palpate::record
