#include "io/igtl/igtl_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "io/igtl/igtl_bytes.h"
#include "palpate/error.h"

namespace palpate::net {
namespace {

constexpr std::uint16_t kNewestVersion = 3;            // of the protocol
constexpr std::uint16_t kExtendedVersion = 2;          // from it on a body has an extended header
constexpr std::size_t kExtensionBytes = 12;            // the extended header's size
constexpr std::size_t kNumbers = 12;                   // of a TRANSFORM: columns of a 3 x 4 matrix
constexpr std::size_t kTransformBytes = 4 * kNumbers;  // single precision
constexpr double kRotationSlack = 0.01;                // deviation from an orthonormal matrix

/// The text of a field that is padded with zeros. Empty: it contains other than printable ASCII.
std::optional<std::string> text_of(std::span<const unsigned char> field) {
  const std::string text(field.begin(), std::find(field.begin(), field.end(), '\0'));
  const bool plain =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
  return plain ? std::optional(text) : std::nullopt;
}

/// A number of N bytes, the highest first.
template <typename Number>
Number number_at(std::span<const unsigned char> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = value << 8U | bytes[i];
  return static_cast<Number>(value);
}

/// The pose of a matrix in the order of the message. Empty: it is no rigid transform.
std::optional<Pose> pose_of(const std::array<double, kNumbers>& numbers) {
  Mat3 rotation;
  Vec3 position;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      rotation(row, column) = numbers[static_cast<std::size_t>(3 * column + row)];
    }
    position(row) = 1e-3 * numbers[static_cast<std::size_t>(9 + row)];
  }
  if (!rotation.allFinite() || !position.allFinite()) return std::nullopt;
  const double off = (rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationSlack) || rotation.determinant() < 0.0) return std::nullopt;
  return Pose{Quat(rotation).normalized(), position};
}

}  // namespace

void IgtlReader::read(std::span<const unsigned char> bytes, const Take& take) {
  while (!bytes.empty()) {
    std::size_t used = 0;
    if (to_skip_ > 0) {
      used = static_cast<std::size_t>(std::min<std::uint64_t>(to_skip_, bytes.size()));
      to_skip_ -= used;
    } else if (body_bytes_ > 0) {
      used = std::min(static_cast<std::size_t>(body_bytes_) - body_.size(), bytes.size());
      body_.insert(body_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(used));
      if (body_.size() == body_bytes_) read_transform(take);
    } else {
      used = std::min(kHeadBytes - head_bytes_, bytes.size());
      std::copy_n(bytes.begin(), used, head_.begin() + static_cast<std::ptrdiff_t>(head_bytes_));
      head_bytes_ += used;
      if (head_bytes_ == kHeadBytes) read_head();
    }
    bytes = bytes.subspan(used);
  }
}

void IgtlReader::read_head() {
  const std::span<const unsigned char> head(head_);
  const auto version = number_at<std::uint16_t>(head);
  const std::optional<std::string> type = text_of(head.subspan(2, 12));
  const std::optional<std::string> name = text_of(head.subspan(14, kLongestName));
  const auto size = number_at<std::uint64_t>(head.subspan(42));
  head_bytes_ = 0;
  if (version < 1 || version > kNewestVersion || !type || type->empty() || !name) {
    throw InputError("the bytes are no OpenIGTLink message of version 1 to 3");
  }
  if (std::exchange(first_, false)) is_slicer_ = *type == "STATUS" && name->empty();
  const bool wanted = *type == "TRANSFORM" && *name == name_;
  const std::uint64_t most = wanted ? kLargestTransform : kLargestBody;
  if (size > most) {
    throw InputError(fmt::format("a {} message has {} bytes, must have at most {}", *type, size, most));
  }
  if (!wanted) {
    to_skip_ = size;
    const bool known = std::find(others_.begin(), others_.end(), *name) != others_.end();
    if (*type == "TRANSFORM" && !known && others_.size() < kMaxOthers) others_.push_back(*name);
    return;
  }
  if (size < kTransformBytes) {
    throw InputError(
        fmt::format("TRANSFORM {} has {} bytes, must have at least {}", name_, size, kTransformBytes));
  }
  version_ = version;
  checksum_ = number_at<std::uint64_t>(head.subspan(50));
  body_bytes_ = size;
  body_.clear();
}

void IgtlReader::read_transform(const Take& take) {
  body_bytes_ = 0;
  if (igtl_checksum(body_) != checksum_) {
    throw InputError("TRANSFORM " + name_ + ": its checksum is wrong");
  }
  std::uint64_t begin = 0;
  std::uint64_t rest = 0;  // bytes of metadata behind the matrix
  if (version_ >= kExtendedVersion) {
    const std::span<const unsigned char> extension(body_);  // the body has at least kTransformBytes
    begin = std::max<std::uint64_t>(number_at<std::uint16_t>(extension), kExtensionBytes);
    rest = std::uint64_t{number_at<std::uint16_t>(extension.subspan(2))} +
           number_at<std::uint32_t>(extension.subspan(4));
  }
  if (begin + kTransformBytes + rest != body_.size()) {
    throw InputError(
        fmt::format("TRANSFORM {}: its {} bytes are not the 12 numbers of a matrix", name_, body_.size()));
  }
  std::array<double, kNumbers> numbers;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const auto bits = number_at<std::uint32_t>(std::span<const unsigned char>(body_).subspan(begin + 4 * i));
    numbers[i] = static_cast<double>(std::bit_cast<float>(bits));
  }
  take(pose_of(numbers));
}

}  // namespace palpate::net
