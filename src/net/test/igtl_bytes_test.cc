// Messages that Palpate packs itself, beside those of the OpenIGTLink library.
#include "io/igtl/igtl_bytes.h"

#include <array>

#include <gtest/gtest.h>

#include "net/igtl_messages.h"

namespace palpate::net {
namespace {

TEST(IgtlBytes, AreTheBytesOfTheLibrary) {
  const Vec3 values(0.5, -1.0 / 3.0, 1e-300);
  const std::array<double, 3> plain = {values.x(), values.y(), values.z()};
  const Pose pose{rotation_about(Vec3(0.6, 0.0, 0.8), 0.7), Vec3(0.001, -0.02, 0.3)};
  for (const std::int64_t time :
       {0LL, 1'700'000'000'000'000'000LL}) {  // the library rounds fractions of a second
    IgtlMessages library(time);
    library.add_transform("Hand", pose);
    library.add_transform("A name of 20 letters", {});
    library.add_sensor("Force", plain, SensorUnit::kNewton);
    library.add_sensor("Torque", plain, SensorUnit::kNewtonMetre);
    IgtlBytes own(time);
    own.add_transform("Hand", pose);
    own.add_transform("A name of 20 letters", {});
    own.add_sensor("Force", values, kIgtlNewton);
    own.add_sensor("Torque", values, kIgtlNewtonMetre);
    EXPECT_EQ(own.bytes(), library.bytes()) << time;
  }
}

TEST(IgtlBytes, AFractionOfASecondIsInUnitsOfTwoToTheMinus32) {
  IgtlBytes own(1'250'000'000);
  own.add_transform("Hand", {});
  const Bytes stamp(own.bytes().begin() + 34, own.bytes().begin() + 42);
  EXPECT_EQ(stamp, (Bytes{0, 0, 0, 1, 0x40, 0, 0, 0}));
}

}  // namespace
}  // namespace palpate::net
