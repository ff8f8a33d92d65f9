#include "run/devices/haply_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "palpate/error.h"

namespace palpate::devices {
namespace {

using nlohmann::json;

constexpr double kQuaternionSlack = 0.05;  // largest deviation of a quaternion's norm from 1, as in a tick
constexpr std::size_t kLongestId = 64;     // characters; the ids of the service have four to five
constexpr int kDeepest = 32;             // nesting levels of a message; the messages of the service have six
constexpr std::size_t kMaxDevices = 64;  // devices of one kind in a message
constexpr std::string_view kArms = "inverse3";
constexpr std::string_view kGrips[] = {"wireless_verse_grip", "verse_grip"};

double number_of(const JsonField& field) { return field.number("a finite number"); }

bool flag_of(const JsonField& field, bool otherwise) { return field.there() ? field.flag() : otherwise; }

std::string id_of(const JsonField& device) {
  const JsonField field = device.at("device_id");
  const std::string want = fmt::format("1 to {} printable characters", kLongestId);
  std::string id = field.text(want);
  const bool printable = std::all_of(id.begin(), id.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (id.empty() || id.size() > kLongestId || !printable) field.fail(want);
  return id;
}

Vec3 vector_of(const JsonField& field) {
  return {number_of(field.at("x")), number_of(field.at("y")), number_of(field.at("z"))};
}

Quat rotation_of(const JsonField& field) {
  const Quat q(number_of(field.at("w")), number_of(field.at("x")), number_of(field.at("y")),
               number_of(field.at("z")));
  const double norm = q.norm();
  if (!std::isfinite(norm) || std::abs(norm - 1.0) > kQuaternionSlack) field.fail("a unit quaternion");
  return q.normalized();
}

json parse(std::string_view text) {
  try {
    return parse_json(text, kDeepest);
  } catch (const InputError& error) {
    throw InputError(std::string("message: ") + error.what());
  }
}

JsonField root_of(const json& message) {
  JsonField root(message, "message: ", JsonField::Quote::kAscii);
  if (!message.is_object()) root.fail("a JSON object");
  return root;
}

/// The device of this id in the message's list of its kind; empty: the list does not have it.
std::optional<JsonField> find(const JsonField& devices, const std::string& id) {
  for (const JsonField& device : devices.elements(kMaxDevices)) {
    if (id_of(device) == id) return device;
  }
  return std::nullopt;
}

/// Why an arm gives no force, from its status. Empty when it gives force.
std::string why_off(const JsonField& status) {
  if (!flag_of(status.at("power_supply"), true)) return "it has no power supply";
  if (!flag_of(status.at("ready"), true)) return "it is not ready";
  return {};
}

/// Buttons as bits. The wireless grip has buttons a, b and c at bits 0 to 2. The wired grip has one button at
/// bit 0.
std::uint32_t pressed_buttons(const JsonField& state) {
  std::uint32_t bits = flag_of(state.at("button"), false) ? 1U : 0U;
  const JsonField buttons = state.at("buttons");
  if (flag_of(buttons.at("a"), false)) bits |= 1U;
  if (flag_of(buttons.at("b"), false)) bits |= 2U;
  if (flag_of(buttons.at("c"), false)) bits |= 4U;
  return bits;
}

void read_grip(const JsonField& root, const std::string& id, haptics::DeviceState& sample) {
  for (const std::string_view kind : kGrips) {
    const std::optional<JsonField> grip = find(root.at(std::string(kind)), id);
    if (!grip) continue;
    const JsonField state = grip->at("state");
    sample.orientation_D = rotation_of(state.at("orientation"));
    sample.buttons = pressed_buttons(state);
    sample.gripper = sample.buttons == 0 ? 1.0 : 0.0;
    return;
  }
  throw InputError("message: verse grip \"" + id + "\": missing, must be in every message");
}

}  // namespace

HaplyInventory read_haply_inventory(std::string_view text) {
  const json message = parse(text);
  const JsonField root = root_of(message);
  HaplyInventory inventory;
  // Only version 3.5 documents these two members. It also documents "vector" in the force command.
  bool vector = root.at("session_id").there();
  for (const JsonField& arm : root.at(std::string(kArms)).elements(kMaxDevices)) {
    inventory.arms.push_back(id_of(arm));
    vector = vector || arm.at("state").at("control_mode").there();
  }
  if (vector) inventory.force_field = HaplyForceField::kVector;
  for (const std::string_view kind : kGrips) {
    for (const JsonField& grip : root.at(std::string(kind)).elements(kMaxDevices)) {
      inventory.grips.push_back(id_of(grip));
    }
  }
  return inventory;
}

HaplySample read_haply_state(std::string_view text, const std::string& arm, const std::string& grip) {
  const json message = parse(text);
  const JsonField root = root_of(message);
  const std::optional<JsonField> device = find(root.at(std::string(kArms)), arm);
  if (!device)
    throw InputError(fmt::format("message: {} \"{}\": missing, must be in every message", kArms, arm));
  HaplySample sample;
  const JsonField state = device->at("state");
  sample.state.position_D = vector_of(state.at("cursor_position"));
  sample.state.velocity_D = vector_of(state.at("cursor_velocity"));
  sample.state.gripper = 1.0;
  if (!grip.empty()) read_grip(root, grip, sample.state);
  sample.off = why_off(device->at("status"));
  if (!sample.off.empty()) sample.state.fault = haptics::Fault::kForceOff;
  return sample;
}

std::string haply_force_command(const std::string& arm, const Vec3& force_D, HaplyForceField field) {
  const char* name = field == HaplyForceField::kVector ? "vector" : "values";
  const json force = {{"x", force_D.x()}, {"y", force_D.y()}, {"z", force_D.z()}};
  const json device = {{"device_id", arm}, {"commands", {{"set_cursor_force", {{name, force}}}}}};
  return json{{"inverse3", json::array({device})}}.dump();
}

}  // namespace palpate::devices
