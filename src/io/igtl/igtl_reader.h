#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::net {

/// Finds the TRANSFORM messages of one name in the bytes that a client sends, and the warnings about them in
/// STATUS messages and metadata. All other messages are skipped and not kept, whatever their size. All
/// members: [setup], one thread.
class IgtlReader final {
 public:
  static constexpr std::size_t kLongestName = 20;
  /// Bytes of a TRANSFORM of that name and of a STATUS; from protocol version 2 on they may carry metadata.
  static constexpr std::uint64_t kLargestTransform = std::uint64_t{64} << 10;
  static constexpr std::uint64_t kLargestBody = std::uint64_t{1} << 30;  // bytes of any other message
  static constexpr std::size_t kMaxOthers = 8;

  /// @param name at most kLongestName characters
  explicit IgtlReader(std::string name) : name_(std::move(name)) {}

  /// The pose of a TRANSFORM: from the inner frame to the client's (sent in mm), m. Empty: its matrix is not
  /// finite, or scales, shears or mirrors. The text is the client's own warning about the pose, which then is
  /// none: metadata whose key ends in "status", such as TransformStatus, with a value other than OK, or the
  /// last STATUS message of this name or without name. Empty: no warning.
  using Take = std::function<void(const std::optional<Pose>&, const std::string&)>;

  /// Reads the next bytes of the stream and calls `take` for each TRANSFORM of that name.
  /// @throws InputError when they are no OpenIGTLink messages of version 1 to 3, or a checksum is wrong. The
  /// following bytes then have no meaning.
  void read(std::span<const unsigned char> bytes, const Take& take);

  /// Names of the other TRANSFORM messages, at most kMaxOthers.
  [[nodiscard]] const std::vector<std::string>& others() const noexcept { return others_; }
  /// Whether the first message was a STATUS without a name, as 3D Slicer's connector sends it.
  [[nodiscard]] bool is_slicer() const noexcept { return is_slicer_; }

 private:
  static constexpr std::size_t kHeadBytes = 58;

  void read_head();
  void read_body(const Take& take);
  void read_status(std::span<const unsigned char> content);
  void read_transform(std::span<const unsigned char> content, const std::string& status, const Take& take);

  std::string name_;
  std::vector<std::string> others_;
  bool first_ = true;
  bool is_slicer_ = false;

  std::array<unsigned char, kHeadBytes> head_{};
  std::size_t head_bytes_ = 0;
  std::uint64_t to_skip_ = 0;        // bytes left of a message that is skipped
  std::vector<unsigned char> body_;  // of a TRANSFORM of that name or a STATUS, so far
  std::uint64_t body_bytes_ = 0;     // its size; 0: no such message has begun
  bool is_status_ = false;           // of these, it is a STATUS
  bool is_named_ = false;            // the message has this name
  std::string warning_;              // of the last STATUS of this name; empty: none
  std::string unnamed_warning_;      // of the last STATUS without name; empty: none
  std::uint16_t version_ = 1;
  std::uint64_t checksum_ = 0;
};

}  // namespace palpate::net
