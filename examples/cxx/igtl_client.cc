// Client of `palpate run --igtl PORT` that needs only the OpenIGTLink library. It prints position and force
// of the first tool and the size of the organ's surface until the run ends.
//   palpate run --igtl 18944 --headless & build/igtl_client 127.0.0.1 18944
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTransformMessage.h>

namespace {

/// Reads the body of a message. Null: the stream has ended, or the checksum is wrong.
template <typename Message>
typename Message::Pointer body_of(igtl::ClientSocket& socket, igtl::MessageHeader::Pointer& header) {
  typename Message::Pointer message = Message::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  const int size = message->GetPackBodySize();
  if (socket.Receive(message->GetPackBodyPointer(), size) != size) return nullptr;
  const bool whole = (message->Unpack(1) & igtl::MessageBase::UNPACK_BODY) != 0;
  return whole ? message : nullptr;
}

/// The printed values of one frame.
struct Reading {
  double time_s = 0.0;
  float tool_mm[3] = {};
  double force_N[3] = {};
};

void print(const Reading& reading) {
  std::cout << reading.time_s << " s: tool at " << reading.tool_mm[0] << ' ' << reading.tool_mm[1] << ' '
            << reading.tool_mm[2] << " mm, force "
            << std::hypot(reading.force_N[0], reading.force_N[1], reading.force_N[2]) << " N\n";
}

/// Reads one message. @return false when the stream has ended
bool take(igtl::ClientSocket& socket, igtl::MessageHeader::Pointer& header, Reading& reading) {
  const std::string type = header->GetDeviceType();
  const std::string name = header->GetDeviceName();
  if (type == "TRANSFORM" && name == "PalpateTool") {
    const auto message = body_of<igtl::TransformMessage>(socket, header);
    if (message.IsNull()) return false;
    message->GetPosition(reading.tool_mm);
  } else if (type == "SENSOR" && name == "PalpateTime") {
    const auto message = body_of<igtl::SensorMessage>(socket, header);
    if (message.IsNull()) return false;
    reading.time_s = message->GetValue(0);
  } else if (type == "SENSOR" && name == "PalpateForce") {
    const auto message = body_of<igtl::SensorMessage>(socket, header);
    if (message.IsNull()) return false;
    for (unsigned int axis = 0; axis < 3; ++axis) reading.force_N[axis] = message->GetValue(axis);
    print(reading);
  } else if (type == "POLYDATA") {
    const auto message = body_of<igtl::PolyDataMessage>(socket, header);
    if (message.IsNull()) return false;
    std::cout << name << ": " << message->GetPoints()->GetNumberOfPoints() << " points, "
              << message->GetPolygons()->GetNumberOfCells() << " triangles\n";
  } else if (type == "STATUS") {
    const auto message = body_of<igtl::StatusMessage>(socket, header);
    if (message.IsNull()) return false;
    if (message->GetCode() != igtl::StatusMessage::STATUS_OK) {
      std::cout << name << ": " << message->GetStatusString() << '\n';
    }
  } else {
    socket.Skip(header->GetBodySizeToRead(), 1);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string host = argc > 1 ? argv[1] : "127.0.0.1";
  const int port = argc > 2 ? std::atoi(argv[2]) : 18944;
  igtl::ClientSocket::Pointer socket = igtl::ClientSocket::New();
  if (socket->ConnectToServer(host.c_str(), port) != 0) {
    std::cerr << "nobody listens at " << host << ':' << port << '\n';
    return 1;
  }
  Reading reading;
  for (;;) {
    igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
    header->InitPack();
    const int size = header->GetPackSize();
    if (socket->Receive(header->GetPackPointer(), size) != size) break;
    header->Unpack();
    if (!take(*socket, header, reading)) break;
  }
  socket->CloseSocket();
  return 0;
}
