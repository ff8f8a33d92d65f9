// Bytes of an OpenIGTLink client, as they are and as the body of a TRANSFORM with the right checksum.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "io/igtl/igtl_messages.h"
#include "io/igtl/igtl_reader.h"

#include "fuzz/input.h"

namespace {

void read_all(std::span<const std::uint8_t> bytes, std::size_t piece) {
  using namespace palpate;
  net::IgtlReader reader("Hand");
  fuzz::read_or_refuse("", [&] {
    for (std::size_t from = 0; from < bytes.size(); from += piece) {
      reader.read(bytes.subspan(from, std::min(piece, bytes.size() - from)),
                  [](const std::optional<Pose>& pose, const std::string& /*status*/) {
                    if (!pose) return;
                    fuzz::require(pose->position.allFinite(), "a position is finite", "");
                    fuzz::require(std::abs(pose->rotation.norm() - 1.0) < 1e-9,
                                  "an orientation is a rotation", "");
                  });
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::vector<std::uint8_t> bytes(data, data + size);
  read_all(bytes, 7);
  if (bytes.empty()) return 0;
  const std::vector<std::uint8_t> body(bytes.begin() + 1, bytes.end());
  std::vector<std::uint8_t> message(58);
  message[1] = static_cast<std::uint8_t>(1 + bytes[0] % 3);  // version
  std::copy_n("TRANSFORM", 9, message.begin() + 2);
  std::copy_n("Hand", 4, message.begin() + 14);
  const std::uint64_t checksum = net::igtl_checksum(body);
  for (unsigned i = 0; i < 8; ++i) {
    message[42 + i] = static_cast<std::uint8_t>(std::uint64_t{body.size()} >> (56 - 8 * i));
    message[50 + i] = static_cast<std::uint8_t>(checksum >> (56 - 8 * i));
  }
  message.insert(message.end(), body.begin(), body.end());
  read_all(message, message.size());
  return 0;
}
