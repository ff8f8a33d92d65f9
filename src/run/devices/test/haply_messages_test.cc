#include "run/devices/haply_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "palpate/error.h"

namespace palpate::devices {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A message in the form of the service's documentation, version 3.5, with two arms and both kinds of grip.
json message() {
  return json::parse(R"({
    "session_id": 7,
    "inverse3": [
      {"device_id": "049D", "config": {"handedness": "left"},
       "state": {"cursor_position": {"x": 0.01, "y": -0.12, "z": 0.15},
                 "cursor_velocity": {"x": 0.1, "y": 0, "z": -0.2}, "control_mode": "idle"},
       "status": {"calibrated": true, "power_supply": true, "ready": true}},
      {"device_id": "04BA",
       "state": {"cursor_position": {"x": 1, "y": 2, "z": 3}, "cursor_velocity": {"x": 4, "y": 5, "z": 6}}}],
    "verse_grip": [{"device_id": "61548",
       "state": {"button": true, "hall": 0, "orientation": {"w": 0.5, "x": -0.5, "y": 0.5, "z": -0.5}}}],
    "wireless_verse_grip": [{"device_id": "77",
       "state": {"buttons": {"a": false, "b": true, "c": true}, "orientation": {"w": 0, "x": 1, "y": 0, "z": 0}}}]
  })");
}

std::string refusal_of(const json& text, const std::string& arm = "049D", const std::string& grip = "77") {
  try {
    (void)read_haply_state(text.is_string() ? text.get<std::string>() : text.dump(), arm, grip);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

TEST(HaplyMessages, AStateHoldsTheArmOfThatNameAndItsWirelessGrip) {
  const HaplySample sample = read_haply_state(message().dump(), "049D", "77");
  EXPECT_EQ(sample.state.position_D, Vec3(0.01, -0.12, 0.15));
  EXPECT_EQ(sample.state.velocity_D, Vec3(0.1, 0.0, -0.2));
  EXPECT_EQ(sample.state.orientation_D.coeffs(), Quat(0.0, 1.0, 0.0, 0.0).coeffs());
  EXPECT_EQ(sample.state.buttons, 6U) << "b and c";
  EXPECT_EQ(sample.state.gripper, 0.0) << "closed while a button is pressed";
  EXPECT_EQ(sample.state.fault, haptics::Fault::kNone);
  EXPECT_EQ(sample.off, "");
  EXPECT_EQ(read_haply_state(message().dump(), "04BA", "77").state.position_D, Vec3(1.0, 2.0, 3.0));
}

TEST(HaplyMessages, AWiredGripHasOneButton) {
  const HaplySample sample = read_haply_state(message().dump(), "04BA", "61548");
  EXPECT_EQ(sample.state.buttons, 1U);
  EXPECT_EQ(sample.state.orientation_D.coeffs(), Quat(0.5, -0.5, 0.5, -0.5).coeffs());
}

TEST(HaplyMessages, WithoutAGripTheOrientationIsTheIdentityAndTheGripperOpen) {
  const HaplySample sample = read_haply_state(message().dump(), "049D", "");
  EXPECT_EQ(sample.state.orientation_D.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(sample.state.buttons, 0U);
  EXPECT_EQ(sample.state.gripper, 1.0);
}

TEST(HaplyMessages, AnOrientationRoundedByTheGripIsANormalisedOne) {
  json rounded = message();
  rounded["wireless_verse_grip"][0]["state"]["orientation"]["x"] = 0.98;
  EXPECT_DOUBLE_EQ(read_haply_state(rounded.dump(), "049D", "77").state.orientation_D.norm(), 1.0);
  rounded["wireless_verse_grip"][0]["state"]["orientation"]["x"] = 0.9;
  EXPECT_EQ(
      refusal_of(rounded),
      "message: wireless_verse_grip[0].state.orientation = {\"w\":0,\"x\":0.9,\"y\":0,\"z\":0}: must be a "
      "unit quaternion");
  rounded["wireless_verse_grip"][0]["state"]["orientation"]["x"] = 1e200;
  EXPECT_THAT(refusal_of(rounded), HasSubstr("must be a unit quaternion"));
}

TEST(HaplyMessages, AnArmWithoutPowerOrNotReadyHasItsForceOff) {
  json off = message();
  off["inverse3"][0]["status"]["power_supply"] = false;
  EXPECT_EQ(read_haply_state(off.dump(), "049D", "").state.fault, haptics::Fault::kForceOff);
  EXPECT_EQ(read_haply_state(off.dump(), "049D", "").off, "it has no power supply");
  EXPECT_EQ(read_haply_state(off.dump(), "04BA", "").state.fault, haptics::Fault::kNone);
  off["inverse3"][0]["status"] = {{"ready", false}};
  EXPECT_EQ(read_haply_state(off.dump(), "049D", "").off, "it is not ready");
}

TEST(HaplyMessages, AMissingOrWrongFieldIsNamedWithItsValue) {
  json wrong = message();
  wrong["inverse3"][0]["state"]["cursor_position"]["x"] = nullptr;
  EXPECT_EQ(refusal_of(wrong),
            "message: inverse3[0].state.cursor_position.x: missing, must be a finite number");
  wrong["inverse3"][0]["state"]["cursor_position"]["x"] = "NaN";
  EXPECT_EQ(refusal_of(wrong),
            "message: inverse3[0].state.cursor_position.x = \"NaN\": must be a finite number");
  wrong = message();
  wrong["inverse3"][0]["state"].erase("cursor_velocity");
  EXPECT_THAT(refusal_of(wrong), HasSubstr("inverse3[0].state.cursor_velocity.x: missing"));
  wrong = message();
  wrong["inverse3"][0]["state"] = 3;
  EXPECT_EQ(refusal_of(wrong), "message: inverse3[0].state = 3: must be an object");
  wrong = message();
  wrong["inverse3"][0]["status"]["ready"] = 1;
  EXPECT_EQ(refusal_of(wrong), "message: inverse3[0].status.ready = 1: must be true or false");
  wrong = message();
  wrong["inverse3"] = "049D";
  EXPECT_EQ(refusal_of(wrong), "message: inverse3 = \"049D\": must be an array");
  wrong = message();
  wrong["inverse3"][0]["device_id"] = "a\nb";
  EXPECT_THAT(refusal_of(wrong), HasSubstr("inverse3[0].device_id = \"a\\nb\": must be 1 to 64 printable"));
}

TEST(HaplyMessages, ADeviceThatIsGoneIsNamed) {
  EXPECT_EQ(refusal_of(message(), "0000"), "message: inverse3 \"0000\": missing, must be in every message");
  EXPECT_EQ(refusal_of(message(), "049D", "78"),
            "message: verse grip \"78\": missing, must be in every message");
}

TEST(HaplyMessages, TextThatIsNoJsonIsRefusedWithItsLineAndByte) {
  EXPECT_EQ(refusal_of(json("{\"inverse3\":\n[nan]}")), "message: line 2, byte 16 of 19: is no JSON");
  EXPECT_THAT(refusal_of(json("")), HasSubstr("is no JSON"));
  EXPECT_THAT(refusal_of(json("{\"a\": \"\\ud800\"}")), HasSubstr("is no JSON"));
  EXPECT_EQ(refusal_of(json("[1]")), "message: it = [1]: must be a JSON object");
  EXPECT_EQ(refusal_of(json("{\"a\": 1e999}")), "message: has a number that no double holds, must be finite");
}

TEST(HaplyMessages, DeepNestingIsRefusedSinceItWouldEndTheProgram) {
  const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');
  EXPECT_EQ(refusal_of(json("{\"inverse3\": " + deep + "}")),
            "message: line 1, byte 45 of 1000014: is nested deeper than 32 levels");
  json brackets = message();
  brackets["inverse3"][0]["config"]["name"] = "\\\"" + std::string(100, '[');  // in a text they do not nest
  EXPECT_EQ(read_haply_state(brackets.dump(), "049D", "").state.position_D, Vec3(0.01, -0.12, 0.15));
}

TEST(HaplyMessages, LongAndUnprintableValuesAreCutInErrors) {
  json wrong = message();
  wrong["inverse3"][0]["state"]["cursor_position"]["x"] = std::string(1000, 'x') + "\n";
  EXPECT_LT(refusal_of(wrong).size(), 150U);
  wrong["inverse3"][0]["state"]["cursor_position"]["x"] = "\xc3\xa9";
  EXPECT_EQ(refusal_of(wrong),
            "message: inverse3[0].state.cursor_position.x = \"??\": must be a finite number");
  wrong["inverse3"] = std::vector<int>(65, 0);
  EXPECT_EQ(refusal_of(wrong), "message: inverse3: has 65 elements, must have at most 64");
}

TEST(HaplyMessages, TheInventoryListsArmsInOrderAndWirelessGripsFirst) {
  const HaplyInventory inventory = read_haply_inventory(message().dump());
  EXPECT_THAT(inventory.arms, ElementsAre("049D", "04BA"));
  EXPECT_THAT(inventory.grips, ElementsAre("77", "61548"));
  EXPECT_THAT(read_haply_inventory("{}").arms, IsEmpty());
  EXPECT_THROW((void)read_haply_inventory("{\"inverse3\": [{}]}"), InputError);
}

TEST(HaplyMessages, TheForceCommandIsThatOfTheServicesVersion) {
  json older = message();
  older.erase("session_id");
  older["inverse3"][0]["state"].erase("control_mode");
  EXPECT_EQ(read_haply_inventory(older.dump()).force_field, HaplyForceField::kValues);
  EXPECT_EQ(read_haply_inventory(message().dump()).force_field, HaplyForceField::kVector);
  older["inverse3"][0]["state"]["control_mode"] = "idle";
  EXPECT_EQ(read_haply_inventory(older.dump()).force_field, HaplyForceField::kVector);
  EXPECT_EQ(json::parse(haply_force_command("04BA", {1.0, -2.5, 0.0}, HaplyForceField::kValues)),
            json::parse(R"({"inverse3": [{"device_id": "04BA", "commands":
                {"set_cursor_force": {"values": {"x": 1.0, "y": -2.5, "z": 0.0}}}}]})"));
  EXPECT_EQ(json::parse(haply_force_command("04BA", {0.0, 0.0, 0.1}, HaplyForceField::kVector)),
            json::parse(R"({"inverse3": [{"device_id": "04BA", "commands":
                {"set_cursor_force": {"vector": {"x": 0.0, "y": 0.0, "z": 0.1}}}}]})"));
}

}  // namespace
}  // namespace palpate::devices
