#include "io/igtl/igtl_reader.h"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/igtl/igtl_messages.h"
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

/// A message's body without its extended header and metadata, and the first warning in the metadata.
struct Parts {
  std::span<const unsigned char> content;
  bool has_status = false;  // the metadata has a status, which may be OK
  std::string warning;      // as in "TransformStatus is INVALID"; empty: none
};

/// Reads the keys that end in "status". @param heads the number of pairs, then for each the sizes of key and
/// value @param data keys and values
void read_metadata(std::span<const unsigned char> heads, std::span<const unsigned char> data, Parts& parts) {
  constexpr std::size_t kCount = 2;
  constexpr std::size_t kHead = 8;  // size of the key, encoding, size of the value
  constexpr std::string_view kStatus = "status";
  if (heads.size() < kCount) return;
  const auto pairs = number_at<std::uint16_t>(heads);
  for (std::size_t n = 0; n < pairs; ++n) {
    const std::size_t head = kCount + n * kHead;
    if (head + kHead > heads.size()) throw InputError("its metadata has fewer pairs than it declares");
    const std::size_t key = number_at<std::uint16_t>(heads.subspan(head));
    const std::size_t value = number_at<std::uint32_t>(heads.subspan(head + 4));
    if (key + value > data.size()) throw InputError("its metadata is shorter than it declares");
    const auto text_of = [](std::span<const unsigned char> bytes) {
      return std::string(bytes.begin(), bytes.end());
    };
    const std::string name = text_of(data.first(key));
    if (lower_case(name).ends_with(kStatus)) {
      const std::string status = text_of(data.subspan(key, value));
      parts.has_status = true;
      if (trimmed(lower_case(status).c_str()) != "ok" && parts.warning.empty())
        parts.warning = excerpt(name) + " is " + excerpt(status);
    }
    data = data.subspan(key + value);
  }
}

/// @return empty content when the sizes in the extended header do not fit the body
Parts parts_of(std::span<const unsigned char> body, std::uint16_t version) {
  Parts parts;
  if (version < kExtendedVersion) {
    parts.content = body;
    return parts;
  }
  if (body.size() < kExtensionBytes) return parts;
  const std::uint64_t begin = std::max<std::uint64_t>(number_at<std::uint16_t>(body), kExtensionBytes);
  const std::uint64_t heads = number_at<std::uint16_t>(body.subspan(2));
  const std::uint64_t data = number_at<std::uint32_t>(body.subspan(4));
  if (begin + heads + data > body.size()) return parts;
  parts.content = body.subspan(begin, body.size() - begin - heads - data);
  const auto metadata = body.last(heads + data);
  read_metadata(metadata.first(heads), metadata.subspan(heads), parts);
  return parts;
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
      if (body_.size() == body_bytes_) read_body(take);
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
  is_named_ = *name == name_;
  is_status_ = *type == "STATUS" && size > 0 && (is_named_ || name->empty());
  const bool wanted = is_status_ || (*type == "TRANSFORM" && is_named_);
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
  if (!is_status_ && size < kTransformBytes) {
    throw InputError(
        fmt::format("TRANSFORM {} has {} bytes, must have at least {}", name_, size, kTransformBytes));
  }
  version_ = version;
  checksum_ = number_at<std::uint64_t>(head.subspan(50));
  body_bytes_ = size;
  body_.clear();
}

void IgtlReader::read_body(const Take& take) {
  body_bytes_ = 0;
  const std::string who = is_status_ ? "STATUS" : "TRANSFORM " + name_;
  if (igtl_checksum(body_) != checksum_) throw InputError(who + ": its checksum is wrong");
  Parts parts;
  try {
    parts = parts_of(body_, version_);
  } catch (const InputError& error) {
    throw InputError(who + ": " + error.what());
  }
  if (is_status_) return read_status(parts.content);
  const std::string& sent = warning_.empty() ? unnamed_warning_ : warning_;
  read_transform(parts.content, parts.has_status ? parts.warning : sent, take);
}

/// Keeps a warning until the next STATUS that is named likewise. 3D Slicer's connector begins with a STATUS
/// without name and code.
void IgtlReader::read_status(std::span<const unsigned char> content) {
  constexpr std::uint16_t kNone = 0;
  constexpr std::uint16_t kOk = 1;
  if (content.size() < sizeof kOk) return;
  const auto code = number_at<std::uint16_t>(content);
  if (code == kNone && !is_named_) return;
  std::string& warning = is_named_ ? warning_ : unnamed_warning_;
  warning = code == kOk ? "" : fmt::format("STATUS {}has the code {}", is_named_ ? name_ + " " : "", code);
}

void IgtlReader::read_transform(std::span<const unsigned char> content, const std::string& status,
                                const Take& take) {
  if (content.size() != kTransformBytes) {
    throw InputError(
        fmt::format("TRANSFORM {}: its {} bytes are not the 12 numbers of a matrix", name_, body_.size()));
  }
  std::array<double, kNumbers> numbers;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    numbers[i] = static_cast<double>(std::bit_cast<float>(number_at<std::uint32_t>(content.subspan(4 * i))));
  }
  take(pose_of(numbers), status);
}

}  // namespace palpate::net
