#include "net/igtl_messages.h"

#include <array>
#include <utility>

#include <igtlPointMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <igtlUnit.h>
#include <igtl_unit.h>

namespace palpate::net {
namespace {

/// Converts a position [m] to mm in the single precision of the messages.
std::array<float, 3> millimetres(const Vec3& place) {
  return {static_cast<float>(1e3 * place.x()), static_cast<float>(1e3 * place.y()),
          static_cast<float>(1e3 * place.z())};
}

igtl::TimeStamp::Pointer stamp_of(std::int64_t unix_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  igtl::TimeStamp::Pointer stamp = igtl::TimeStamp::New();
  stamp->SetTime(static_cast<igtlUint32>(unix_ns / kSecond), static_cast<igtlUint32>(unix_ns % kSecond));
  return stamp;
}

/// Packs a unit into OpenIGTLink's 64 bits. It calls the library's C functions because the class igtl::Unit
/// keeps only the last of several units.
igtl_unit unit_of(SensorUnit unit) {
  igtl_unit_data data{};
  igtl_unit_init(&data);
  const auto factor = [&data](std::size_t place, int of) {
    data.unit[place] = static_cast<igtl_uint8>(of);
    data.exp[place] = 1;
  };
  switch (unit) {
    case SensorUnit::kNewton:
      factor(0, igtl::Unit::SI_DERIVED_NEWTON);
      break;
    case SensorUnit::kNewtonMetre:
      factor(0, igtl::Unit::SI_DERIVED_NEWTON);
      factor(1, igtl::Unit::SI_BASE_METER);
      break;
    case SensorUnit::kMillimetre:
      data.prefix = igtl::Unit::SI_PREFIX_MILLI;
      factor(0, igtl::Unit::SI_BASE_METER);
      break;
    case SensorUnit::kSecond:
      factor(0, igtl::Unit::SI_BASE_SECOND);
      break;
  }
  return igtl_unit_pack(&data);
}

/// Packs a message. @return its bytes, header and body
std::span<const unsigned char> packed(igtl::MessageBase& message, const std::string& name,
                                      std::int64_t unix_ns) {
  igtl::TimeStamp::Pointer stamp = stamp_of(unix_ns);
  message.SetDeviceName(name.c_str());
  message.SetTimeStamp(stamp);
  message.Pack();
  return {static_cast<const unsigned char*>(message.GetPackPointer()),
          static_cast<std::size_t>(message.GetPackSize())};
}

}  // namespace

template <typename Message>
void IgtlMessages::add(Message& message, const std::string& name) {
  const std::span<const unsigned char> more = packed(message, name, unix_ns_);
  bytes_.insert(bytes_.end(), more.begin(), more.end());
}

void IgtlMessages::add_transform(const std::string& name, const Pose& pose_W) {
  const Mat3 rotation = pose_W.rotation.toRotationMatrix();
  const std::array<float, 3> position = millimetres(pose_W.position);
  igtl::Matrix4x4 matrix{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      matrix[row][column] = static_cast<float>(rotation(row, column));
    matrix[row][3] = position[static_cast<std::size_t>(row)];
  }
  matrix[3][3] = 1.0F;
  igtl::TransformMessage::Pointer message = igtl::TransformMessage::New();
  message->SetMatrix(matrix);
  add(*message, name);
}

void IgtlMessages::add_point(const std::string& name, const std::string& label, const Vec3& place_W,
                             bool shown) {
  igtl::PointElement::Pointer point = igtl::PointElement::New();
  point->SetName(label.c_str());
  point->SetGroupName("Contact");
  point->SetRGBA(255, 200, 0, shown ? 255 : 0);
  const std::array<float, 3> place = millimetres(place_W);
  point->SetPosition(place[0], place[1], place[2]);
  point->SetRadius(0.0F);
  point->SetOwner("");
  igtl::PointMessage::Pointer message = igtl::PointMessage::New();
  message->AddPointElement(point);
  add(*message, name);
}

void IgtlMessages::add_sensor(const std::string& name, std::span<const double> values, SensorUnit unit) {
  igtl::SensorMessage::Pointer message = igtl::SensorMessage::New();
  message->SetLength(static_cast<unsigned int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) message->SetValue(static_cast<unsigned int>(i), values[i]);
  message->SetUnit(unit_of(unit));
  add(*message, name);
}

void IgtlMessages::add_string(const std::string& name, const std::string& text) {
  igtl::StringMessage::Pointer message = igtl::StringMessage::New();
  message->SetEncoding(IGTL_STRING_MESSAGE_DEFAULT_ENCODING);
  message->SetString(text.c_str());
  add(*message, name);
}

void IgtlMessages::add_status(const std::string& name, StatusCode code, std::int64_t number,
                              const std::string& error, const std::string& text) {
  igtl::StatusMessage::Pointer message = igtl::StatusMessage::New();
  message->SetCode(static_cast<int>(code));
  message->SetSubCode(number);
  message->SetErrorName(error.c_str());
  message->SetStatusString(text.c_str());
  add(*message, name);
}

struct IgtlSurface::Impl {
  std::string name;
  igtl::PolyDataPointArray::Pointer points = igtl::PolyDataPointArray::New();
  igtl::PolyDataMessage::Pointer message = igtl::PolyDataMessage::New();
};

IgtlSurface::IgtlSurface(std::string name, std::span<const geometry::Triangle> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->name = std::move(name);
  igtl::PolyDataCellArray::Pointer cells = igtl::PolyDataCellArray::New();
  for (const geometry::Triangle& triangle : triangles) {
    std::array<igtlUint32, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) corners[i] = static_cast<igtlUint32>(triangle[i]);
    cells->AddCell(3, corners.data());
  }
  impl_->message->SetPoints(impl_->points.GetPointer());
  impl_->message->SetPolygons(cells.GetPointer());
}

IgtlSurface::~IgtlSurface() = default;

Bytes IgtlSurface::message(std::span<const Vec3> vertices, std::int64_t unix_ns) {
  impl_->points->SetNumberOfPoints(static_cast<int>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::array<float, 3> place = millimetres(vertices[i]);
    impl_->points->SetPoint(static_cast<unsigned int>(i), place[0], place[1], place[2]);
  }
  const std::span<const unsigned char> bytes = packed(*impl_->message, impl_->name, unix_ns);
  return {bytes.begin(), bytes.end()};
}

}  // namespace palpate::net
