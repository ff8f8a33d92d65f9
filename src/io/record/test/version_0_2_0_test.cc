// A recording that version 0.2.0 wrote, by its C interface: 100 ticks of its scripted press, every 70th
// sample, of a ball of 5 mm into the built-in ball of tissue liver, without a hand. Contact has changed since
// then, its file format has not.
#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "core/base/text.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/recording.h"

namespace palpate::record {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kHashOf020 = 0xa404ec29371c26bb;  // that version's replay printed it
constexpr std::uint64_t kDeepestTickOf020 = 41;

class RecordingOfVersion020 : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder / "press.h5";
    std::ofstream out(file, std::ios::binary);
    gzFile in = gzopen(PALPATE_RECORDINGS "/press-0.2.0.h5.gz", "rb");
    ASSERT_NE(in, nullptr);
    std::array<char, 65536> part;
    for (int size = 0; (size = gzread(in, part.data(), part.size())) > 0;) out.write(part.data(), size);
    ASSERT_EQ(gzclose(in), Z_OK);
    out.close();
    recording_ = read_recording(file);
  }

  static Recording recording_;
};

Recording RecordingOfVersion020::recording_;

TEST_F(RecordingOfVersion020, IsOpenedWithItsSceneAndTissue) {
  EXPECT_EQ(recording_.facts.version, "0.2.0");
  EXPECT_TRUE(recording_.facts.complete);
  EXPECT_EQ(recording_.scene.name, "a press of version 0.2.0");
  EXPECT_EQ(recording_.scene.organ.vertices.size(), 642U);
  EXPECT_EQ(recording_.scene.tissue.name, "liver");
  EXPECT_EQ(recording_.scene.tissue.k1, 25.0);
  EXPECT_EQ(recording_.scene.tissue.law, model::LawKind::kLayered);
}

TEST_F(RecordingOfVersion020, HasTheHashThatThisVersionGave) {
  EXPECT_EQ(recording_.rows.size(), 100U);
  EXPECT_EQ(hash_rows(recording_.rows), kHashOf020);
}

TEST_F(RecordingOfVersion020, IsReplayedToItsEndAndWhatDiffersIsSaid) {
  const ReplayResult result = replay(recording_);
  EXPECT_EQ(result.rows_compared, 100U);
  EXPECT_EQ(result.hash == kHashOf020, result.rows_different == 0);
  EXPECT_EQ(result.first_difference.empty(), result.rows_different == 0);
}

TEST_F(RecordingOfVersion020, IsReplayedToTheSameDepthWithinOnePercent) {
  const haptics::TickRow& deepest = recording_.rows.at(kDeepestTickOf020);
  const haptics::Snapshot replayed = snapshots_at(recording_, {kDeepestTickOf020}).front();
  EXPECT_NEAR(deepest.depth, 12e-3, 1e-6);  // the scripted press
  EXPECT_NEAR(replayed.results.front().depth, deepest.depth, 0.01 * deepest.depth);
}

TEST_F(RecordingOfVersion020, IsExportedWithAllItsRows) {
  const test::TemporaryFolder folder;
  export_csv(recording_, folder / "press.csv");
  std::ifstream in(folder / "press.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 101U);
  EXPECT_THAT(lines.at(1 + kDeepestTickOf020),
              HasSubstr(shortest(recording_.rows.at(kDeepestTickOf020).tissue_force)));
}

}  // namespace
}  // namespace palpate::record
