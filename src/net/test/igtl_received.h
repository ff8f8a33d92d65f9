#pragma once
// OpenIGTLink messages as a client of the same library reads them. Every checksum is checked.
#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlPointMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

namespace palpate::net::test {

/// One message with its header unpacked and its body still packed.
struct Received {
  std::string type;
  std::string name;
  double time = 0.0;  // s since 1970
  igtl::MessageHeader::Pointer header;
  std::vector<unsigned char> body;

  /// Unpacks the body. @throws std::runtime_error when its checksum or its type is wrong
  template <typename Message>
  [[nodiscard]] typename Message::Pointer as() const {
    typename Message::Pointer message = Message::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    std::memcpy(message->GetPackBodyPointer(), body.data(), body.size());
    if ((message->Unpack(1) & igtl::MessageBase::UNPACK_BODY) == 0) {
      throw std::runtime_error(type + " " + name + ": the body cannot be read");
    }
    return message;
  }
  [[nodiscard]] std::vector<double> values() const {
    const igtl::SensorMessage::Pointer message = as<igtl::SensorMessage>();
    std::vector<double> all;
    for (unsigned int i = 0; i < message->GetLength(); ++i) all.push_back(message->GetValue(i));
    return all;
  }
  [[nodiscard]] std::array<float, 3> position() const {
    std::array<float, 3> place{};
    as<igtl::TransformMessage>()->GetPosition(place.data());
    return place;
  }
};

/// Unpacks a header, which states the size of the body that follows.
inline Received header_from(const igtl::MessageHeader::Pointer& header) {
  if ((header->Unpack(0) & igtl::MessageHeader::UNPACK_HEADER) == 0) throw std::runtime_error("no header");
  igtl::TimeStamp::Pointer stamp = igtl::TimeStamp::New();
  header->GetTimeStamp(stamp);
  Received received{header->GetDeviceType(), header->GetDeviceName(), stamp->GetTimeStamp(), header, {}};
  received.body.resize(static_cast<std::size_t>(header->GetBodySizeToRead()));
  return received;
}

/// Reads messages that follow each other in `bytes`.
inline std::vector<Received> read_all(std::span<const unsigned char> bytes) {
  std::vector<Received> all;
  while (!bytes.empty()) {
    igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
    header->InitPack();
    const auto size = static_cast<std::size_t>(header->GetPackSize());
    if (bytes.size() < size) throw std::runtime_error("a header is cut off");
    std::memcpy(header->GetPackPointer(), bytes.data(), size);
    Received received = header_from(header);
    bytes = bytes.subspan(size);
    if (bytes.size() < received.body.size()) throw std::runtime_error("a body is cut off");
    std::memcpy(received.body.data(), bytes.data(), received.body.size());
    bytes = bytes.subspan(received.body.size());
    all.push_back(std::move(received));
  }
  return all;
}

/// A client that uses the library's socket.
class Client final {
 public:
  explicit Client(int port) {
    if (socket_->ConnectToServer("127.0.0.1", port) != 0) throw std::runtime_error("no connection");
    socket_->SetReceiveTimeout(20'000);  // ms; a test that waits for 20 s has failed
  }
  ~Client() { socket_->CloseSocket(); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Next message. Empty at the end of the stream.
  [[nodiscard]] std::optional<Received> next() {
    igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
    header->InitPack();
    if (!take(header->GetPackPointer(), header->GetPackSize())) return std::nullopt;
    Received received = header_from(header);
    if (!take(received.body.data(), static_cast<int>(received.body.size()))) return std::nullopt;
    return received;
  }
  /// Next message of a type and a name. @throws std::runtime_error when the stream ends first
  [[nodiscard]] Received next(const std::string& type, const std::string& name) {
    while (std::optional<Received> received = next()) {
      if (received->type == type && received->name == name) return *std::move(received);
    }
    throw std::runtime_error("the stream ended before a " + type + " " + name);
  }
  void send(std::span<const unsigned char> bytes) {
    socket_->Send(bytes.data(), static_cast<int>(bytes.size()));
  }

 private:
  /// Receives `size` bytes. With a timeout set, a call of the library returns the bytes that have arrived so
  /// far.
  bool take(void* to, int size) {
    for (int done = 0; done < size;) {
      const int got = socket_->Receive(static_cast<char*>(to) + done, size - done, 0);
      if (got <= 0) return false;
      done += got;
    }
    return true;
  }

  igtl::ClientSocket::Pointer socket_ = igtl::ClientSocket::New();
};

}  // namespace palpate::net::test
