#include "run/devices/models.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate::devices {
namespace {

using haptics::DeviceAbilities;

TEST(Models, AreFoundByAPartOfTheirNameWhateverTheCase) {
  EXPECT_EQ(abilities_of_model("omega.7").max_force, 12.0);
  EXPECT_EQ(abilities_of_model("Falcon").max_stiffness, 3000.0);
  EXPECT_EQ(abilities_of_model("Touch").max_stiffness, 400.0);
  EXPECT_EQ(abilities_of_model("Geomagic Touch X").max_stiffness, 1000.0) << "not the shorter name";
  EXPECT_TRUE(abilities_of_model("sigma.7").torque);
  EXPECT_FALSE(abilities_of_model("PHANTOM Omni").torque);
  EXPECT_EQ(abilities_of_model("lambda.7").model, "lambda.7");
}

TEST(Models, OfAnUnknownOneNothingIsKnownAndNothingLimited) {
  DeviceAbilities unknown;
  unknown.model = "stand-in.7";
  EXPECT_EQ(abilities_of_model("stand-in.7"), unknown);
  EXPECT_TRUE(std::isinf(unknown.max_force));
  EXPECT_TRUE(std::isinf(abilities_of_model("Inverse3").max_stiffness)) << "its maker says none";
}

}  // namespace
}  // namespace palpate::devices
