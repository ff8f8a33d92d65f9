// Poses in the bytes of a client, whole, in pieces, and malformed.
#include "io/igtl/igtl_reader.h"

#include <cstring>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/igtl/igtl_messages.h"
#include "palpate/error.h"

namespace palpate::net {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Pose kPose{rotation_about(Vec3::UnitZ(), std::numbers::pi / 2), Vec3(0.001, -0.02, 0.3)};

Bytes transform(const std::string& name, const Pose& pose = kPose) {
  IgtlMessages messages(0);
  messages.add_transform(name, pose);
  return messages.bytes();
}

/// Bytes of a number, the highest first.
void append(Bytes& to, std::uint64_t number, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) to.push_back(static_cast<unsigned char>(number >> (8 * i)));
}

/// A message by the protocol's document, with the right checksum unless `checksum` is added to it.
Bytes message(std::uint16_t version, const char* type, const char* name, Bytes body,
              std::uint64_t checksum = 0) {
  Bytes bytes;
  append(bytes, version, 2);
  char field[32] = {};
  std::strncpy(field, type, 12);
  std::strncpy(field + 12, name, 20);
  bytes.insert(bytes.end(), field, field + 32);
  append(bytes, 0, 8);
  append(bytes, body.size(), 8);
  append(bytes, igtl_checksum(body) + checksum, 8);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Bytes matrix(const std::array<float, 12>& numbers) {
  Bytes body;
  for (const float number : numbers) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, 4);
    append(body, bits, 4);
  }
  return body;
}

const std::array<float, 12> kStraight = {1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30};

std::vector<std::optional<Pose>> poses_in(IgtlReader& reader, const Bytes& bytes) {
  std::vector<std::optional<Pose>> all;
  reader.read(bytes,
              [&](const std::optional<Pose>& pose, const std::string& /*status*/) { all.push_back(pose); });
  return all;
}

std::string refusal_of(const Bytes& bytes) {
  IgtlReader reader("Hand");
  try {
    (void)poses_in(reader, bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(IgtlChecksum, IsThatOfEcma182) {
  const std::string check = "123456789";  // of the catalogue of CRC algorithms
  EXPECT_EQ(igtl_checksum(Bytes(check.begin(), check.end())), 0x6c40df5f0b497347U);
}

TEST(IgtlReader, ATransformOfItsNameIsAPoseInMetres) {
  IgtlReader reader("Hand");
  const auto poses = poses_in(reader, transform("Hand"));
  ASSERT_EQ(poses.size(), 1u);
  ASSERT_TRUE(poses[0]);
  EXPECT_LT((poses[0]->position - kPose.position).norm(), 1e-8) << "single precision";
  EXPECT_LT(poses[0]->rotation.angularDistance(kPose.rotation), 1e-6);
}

TEST(IgtlReader, MessagesMayComeInPiecesOfOneByte) {
  Bytes bytes = transform("Hand");
  const Bytes other = transform("Other");
  bytes.insert(bytes.end(), other.begin(), other.end());
  bytes.insert(bytes.end(), bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(other.size()));
  IgtlReader reader("Hand");
  std::size_t poses = 0;
  for (const unsigned char byte : bytes) poses += poses_in(reader, {byte}).size();
  EXPECT_EQ(poses, 2u);
}

TEST(IgtlReader, OtherMessagesAreSkippedAndOtherTransformsListedOnce) {
  IgtlReader reader("Hand");
  EXPECT_TRUE(poses_in(reader, message(1, "IMAGE", "Hand", Bytes(100'000))).empty());
  EXPECT_TRUE(poses_in(reader, message(1, "GET_TRANSFOR", "Hand", {})).empty());
  for (const char* name : {"Probe", "Stylus", "Probe"})
    EXPECT_TRUE(poses_in(reader, transform(name)).empty());
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(poses_in(reader, transform("T" + std::to_string(i))).empty());
  EXPECT_EQ(reader.others().size(), IgtlReader::kMaxOthers);
  EXPECT_THAT(std::vector(reader.others().begin(), reader.others().begin() + 3),
              ElementsAre("Probe", "Stylus", "T0"));
  EXPECT_EQ(poses_in(reader, transform("Hand")).size(), 1u);
}

TEST(IgtlReader, Version2MayCarryAnExtendedHeaderAndMetadata) {
  Bytes body;
  append(body, 14, 2);  // extended header: its size, 2 bytes more than today's
  append(body, 4, 2);   // size of the metadata's header
  append(body, 3, 4);   // size of the metadata
  append(body, 77, 4);  // message number
  append(body, 0, 2);
  const Bytes numbers = matrix(kStraight);
  body.insert(body.end(), numbers.begin(), numbers.end());
  append(body, 0, 7);
  IgtlReader reader("Hand");
  const auto poses = poses_in(reader, message(2, "TRANSFORM", "Hand", body));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0]->position, Vec3(0.01, 0.02, 0.03));
  body.pop_back();
  EXPECT_THAT(refusal_of(message(2, "TRANSFORM", "Hand", body)), HasSubstr("not the 12 numbers"));
  for (const std::uint64_t sizes : {0xffff'ffff'ffff'ffffULL, 0ULL, 0x000c'0000'ffff'ffffULL}) {
    Bytes wrong;
    append(wrong, sizes, 8);
    append(wrong, 0, 4);
    wrong.insert(wrong.end(), numbers.begin(), numbers.end());
    const std::string why = refusal_of(message(3, "TRANSFORM", "Hand", wrong));
    EXPECT_EQ(why.empty(), sizes == 0) << why;
  }
}

/// What the client says about the poses in these messages, one text a TRANSFORM.
std::vector<std::string> warnings_in(IgtlReader& reader, const Bytes& bytes) {
  std::vector<std::string> all;
  reader.read(bytes, [&](const std::optional<Pose>&, const std::string& status) { all.push_back(status); });
  return all;
}

/// A TRANSFORM of a later protocol version, with metadata.
Bytes with_metadata(std::uint16_t version, const std::vector<std::pair<std::string, std::string>>& pairs) {
  Bytes heads;
  Bytes data;
  append(heads, pairs.size(), 2);
  for (const auto& [key, value] : pairs) {
    append(heads, key.size(), 2);
    append(heads, 3, 2);  // US-ASCII
    append(heads, value.size(), 4);
    data.insert(data.end(), key.begin(), key.end());
    data.insert(data.end(), value.begin(), value.end());
  }
  Bytes body;
  append(body, 12, 2);
  append(body, heads.size(), 2);
  append(body, data.size(), 4);
  append(body, 1, 4);
  for (const Bytes& part : {matrix(kStraight), heads, data})
    body.insert(body.end(), part.begin(), part.end());
  return message(version, "TRANSFORM", "Hand", body);
}

TEST(IgtlReader, MetadataWithAnyStatusButOkIsTheTrackersWarning) {
  for (const std::uint16_t version : {std::uint16_t{2}, std::uint16_t{3}}) {
    for (const char* key : {"TransformStatus", "Status", "HandToTrackerTransformStatus", "status"}) {
      for (const char* value : {"INVALID", "MISSING", "OUT_OF_VIEW", "", "0", "NOT OK"}) {
        IgtlReader reader("Hand");
        EXPECT_THAT(warnings_in(reader, with_metadata(version, {{"Name", "x"}, {key, value}})),
                    ElementsAre(std::string(key) + " is " + value));
      }
      for (const char* value : {"OK", "ok", " OK "}) {
        IgtlReader reader("Hand");
        EXPECT_THAT(warnings_in(reader, with_metadata(version, {{key, value}})), ElementsAre(""));
      }
    }
    IgtlReader reader("Hand");
    EXPECT_THAT(warnings_in(reader, with_metadata(version, {{"StatusText", "INVALID"}})), ElementsAre(""));
    EXPECT_THAT(
        warnings_in(reader, with_metadata(version, {{"Status", "OK"}, {"TransformStatus", "INVALID"}})),
        ElementsAre("TransformStatus is INVALID"));
  }
}

TEST(IgtlReader, MetadataThatIsShorterThanItDeclaresIsRefused) {
  const Bytes whole = with_metadata(2, {{"Status", "INVALID"}});
  for (const std::size_t at : {58U + 12U + 48U, 58U + 12U + 48U + 2U, 58U + 12U + 48U + 6U}) {
    Bytes damaged(whole.begin() + 58, whole.end());
    damaged[at - 58] = 0xff;  // of the number of pairs, of a key's size and of a value's
    EXPECT_THAT(refusal_of(message(2, "TRANSFORM", "Hand", damaged)),
                HasSubstr("TRANSFORM Hand: its metadata"));
  }
}

Bytes status(const char* name, std::uint16_t code) {
  Bytes body;
  append(body, code, 2);
  body.resize(31);
  return message(1, "STATUS", name, body);
}

TEST(IgtlReader, AStatusOtherThanOkOfTheHandOrWithoutNameHoldsUntilItsNextOne) {
  for (const char* name : {"Hand", ""}) {
    IgtlReader reader("Hand");
    EXPECT_TRUE(warnings_in(reader, status(name, 13)).empty());
    for (int i = 0; i < 2; ++i) {
      EXPECT_THAT(warnings_in(reader, transform("Hand")), ElementsAre(HasSubstr("has the code 13"))) << name;
    }
    EXPECT_THAT(warnings_in(reader, with_metadata(2, {{"TransformStatus", "OK"}})), ElementsAre(""))
        << "the pose's own status counts more";
    EXPECT_TRUE(warnings_in(reader, status(*name == '\0' ? "Hand" : "", 1)).empty());
    EXPECT_THAT(warnings_in(reader, transform("Hand")), ElementsAre(HasSubstr("has the code 13"))) << name;
    EXPECT_TRUE(warnings_in(reader, status(name, 1)).empty());
    EXPECT_THAT(warnings_in(reader, transform("Hand")), ElementsAre("")) << name;
  }
}

TEST(IgtlReader, AStatusOfAnotherToolAndAGreetingDoNotWarnAboutTheHand) {
  IgtlReader reader("Hand");
  EXPECT_TRUE(warnings_in(reader, message(1, "STATUS", "", Bytes(30))).empty());  // code 0, as of 3D Slicer
  EXPECT_TRUE(warnings_in(reader, status("Probe", 18)).empty()) << "before any TRANSFORM";
  for (int tool = 1; tool <= 9; ++tool) {
    const std::string name = "Tool" + std::to_string(tool);
    EXPECT_TRUE(warnings_in(reader, transform(name)).empty());
    EXPECT_TRUE(warnings_in(reader, status(name.c_str(), 18)).empty());
  }
  EXPECT_THAT(warnings_in(reader, transform("Hand")), ElementsAre(""));
}

TEST(IgtlReader, AMatrixThatIsNoRotationGivesNoPose) {
  const struct {
    std::size_t place;
    float value;
  } wrong[] = {{0, 1.02F},
               {1, 0.02F},
               {8, -1.0F},
               {0, 0.0F},
               {4, std::numeric_limits<float>::quiet_NaN()},
               {9, std::numeric_limits<float>::infinity()}};
  for (const auto& one : wrong) {
    std::array<float, 12> numbers = kStraight;
    numbers[one.place] = one.value;
    IgtlReader reader("Hand");
    const auto poses = poses_in(reader, message(1, "TRANSFORM", "Hand", matrix(numbers)));
    ASSERT_EQ(poses.size(), 1u);
    EXPECT_FALSE(poses[0]) << one.place << ' ' << one.value;
  }
}

TEST(IgtlReader, BytesThatAreNoMessagesAreRefused) {
  const Bytes body = matrix(kStraight);
  EXPECT_THAT(refusal_of(Bytes(58, 'x')), HasSubstr("no OpenIGTLink message"));
  EXPECT_THAT(refusal_of(message(0, "TRANSFORM", "Hand", body)), HasSubstr("version 1 to 3"));
  EXPECT_THAT(refusal_of(message(4, "TRANSFORM", "Hand", body)), HasSubstr("version 1 to 3"));
  EXPECT_THAT(refusal_of(message(1, "", "Hand", body)), HasSubstr("no OpenIGTLink message"));
  EXPECT_THAT(refusal_of(message(1, "TRANSFORM", "H\xff", body)), HasSubstr("no OpenIGTLink message"));
  EXPECT_THAT(refusal_of(message(1, "TRANSFORM", "Hand", body, 1)), HasSubstr("checksum"));
  EXPECT_THAT(refusal_of(message(1, "TRANSFORM", "Hand", Bytes(47))), HasSubstr("at least 48"));
  EXPECT_THAT(refusal_of(message(1, "TRANSFORM", "Hand", Bytes(49))), HasSubstr("not the 12 numbers"));
  EXPECT_THAT(refusal_of(message(1, "TRANSFORM", "Hand", Bytes(65537))), HasSubstr("at most 65536"));
  Bytes huge = message(1, "IMAGE", "x", {});
  huge[42] = 0xff;  // of the body's size
  EXPECT_THAT(refusal_of(huge), HasSubstr("at most 1073741824"));
}

TEST(IgtlReader, RecognisesTheFirstMessageOfSlicersConnector) {
  IgtlReader slicer("Hand");
  (void)poses_in(slicer, message(1, "STATUS", "", Bytes(30)));
  EXPECT_TRUE(slicer.is_slicer());
  IgtlReader other("Hand");
  (void)poses_in(other, transform("Hand"));
  (void)poses_in(other, message(1, "STATUS", "", Bytes(30)));
  EXPECT_FALSE(other.is_slicer());
}

}  // namespace
}  // namespace palpate::net
