#include "run/devices/haply_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/system/json_text.h"
#include "palpate/error.h"

namespace palpate::devices {
namespace {

using nlohmann::json;

constexpr double kQuaternionSlack = 0.05;    // largest deviation of a quaternion's norm from 1, as in a tick
constexpr std::size_t kLongestId = 64;       // characters; the ids of the service have four to five
constexpr std::size_t kLongestExcerpt = 40;  // characters of a value in an error
constexpr int kDeepest = 32;              // nesting levels of a message; the messages of the service have six
constexpr std::size_t kMostDevices = 64;  // devices of one kind in a message
constexpr std::string_view kArms = "inverse3";
constexpr std::string_view kGrips[] = {"wireless_verse_grip", "verse_grip"};

/// Shortens a value from the service for an error message and replaces characters that are not printable
/// ASCII.
std::string excerpt(std::string text) {
  if (text.size() > kLongestExcerpt) text = text.substr(0, kLongestExcerpt) + "...";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

[[noreturn]] void refuse(const std::string& field, const json* value, const std::string& want) {
  if (value == nullptr) throw InputError(fmt::format("message: {}: missing, must be {}", field, want));
  throw InputError(fmt::format("message: {} = {}: must be {}", field,
                               excerpt(value->dump(-1, ' ', false, json::error_handler_t::replace)), want));
}

/// A value of a message and its name in the message, for errors.
class Field final {
 public:
  Field(const json* value, std::string name) : value_(value), name_(std::move(name)) {}

  [[nodiscard]] bool there() const { return value_ != nullptr; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[noreturn]] void fail(const std::string& want) const { refuse(name_, value_, want); }

  /// Member of an object. A null member counts as missing.
  [[nodiscard]] Field at(const std::string& key) const {
    if (there() && !value_->is_object()) fail("an object");
    const json* member = nullptr;
    if (there()) {
      const auto found = value_->find(key);
      if (found != value_->end() && !found->is_null()) member = &*found;
    }
    return {member, name_.empty() ? key : name_ + "." + key};
  }
  [[nodiscard]] std::vector<Field> elements() const {
    std::vector<Field> all;
    if (!there()) return all;
    if (!value_->is_array()) fail("an array");
    if (value_->size() > kMostDevices) {
      throw InputError(fmt::format("message: {}: has {} elements, must have at most {}", name_,
                                   value_->size(), kMostDevices));
    }
    for (std::size_t i = 0; i < value_->size(); ++i) {
      all.emplace_back(&(*value_)[i], fmt::format("{}[{}]", name_, i));
    }
    return all;
  }
  [[nodiscard]] double number() const {
    if (!there() || !value_->is_number()) fail("a finite number");
    const auto read = value_->get<double>();
    if (!std::isfinite(read)) fail("a finite number");
    return read;
  }
  /// Reads a boolean. @return `otherwise` when the value is missing
  [[nodiscard]] bool flag(bool otherwise) const {
    if (!there()) return otherwise;
    if (!value_->is_boolean()) fail("true or false");
    return value_->get<bool>();
  }
  [[nodiscard]] std::string id() const {
    const std::string want = fmt::format("1 to {} printable characters", kLongestId);
    if (!there() || !value_->is_string()) fail(want);
    const auto& text = value_->get_ref<const std::string&>();
    const bool printable = std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (text.empty() || text.size() > kLongestId || !printable) fail(want);
    return text;
  }
  [[nodiscard]] Vec3 vector() const { return {at("x").number(), at("y").number(), at("z").number()}; }
  [[nodiscard]] Quat rotation() const {
    const Quat q(at("w").number(), at("x").number(), at("y").number(), at("z").number());
    const double norm = q.norm();
    if (!std::isfinite(norm) || std::abs(norm - 1.0) > kQuaternionSlack) fail("a unit quaternion");
    return q.normalized();
  }

 private:
  const json* value_;  // null: missing
  std::string name_;
};

json parse(std::string_view text) {
  json message;
  try {
    message = parse_json(text, kDeepest);
  } catch (const InputError& error) {
    throw InputError(std::string("message: ") + error.what());
  }
  if (!message.is_object()) refuse("it", &message, "a JSON object");
  return message;
}

Field find(const Field& devices, const std::string& id) {
  for (const Field& device : devices.elements()) {
    if (device.at("device_id").id() == id) return device;
  }
  return {nullptr, fmt::format("{} \"{}\"", devices.name(), id)};
}

/// Why an arm gives no force, from its status. Empty when it gives force.
std::string why_off(const Field& status) {
  if (!status.at("power_supply").flag(true)) return "it has no power supply";
  if (!status.at("ready").flag(true)) return "it is not ready";
  return {};
}

/// Buttons as bits. The wireless grip has buttons a, b and c at bits 0 to 2. The wired grip has one button at
/// bit 0.
std::uint32_t pressed_buttons(const Field& state) {
  std::uint32_t bits = state.at("button").flag(false) ? 1U : 0U;
  const Field buttons = state.at("buttons");
  if (buttons.at("a").flag(false)) bits |= 1U;
  if (buttons.at("b").flag(false)) bits |= 2U;
  if (buttons.at("c").flag(false)) bits |= 4U;
  return bits;
}

void read_grip(const Field& root, const std::string& id, haptics::DeviceState& sample) {
  for (const std::string_view kind : kGrips) {
    const Field grip = find(root.at(std::string(kind)), id);
    if (!grip.there()) continue;
    const Field state = grip.at("state");
    sample.orientation_D = state.at("orientation").rotation();
    sample.buttons = pressed_buttons(state);
    sample.gripper = sample.buttons == 0 ? 1.0 : 0.0;
    return;
  }
  throw InputError("message: verse grip \"" + id + "\": missing, must be in every message");
}

}  // namespace

HaplyInventory read_haply_inventory(std::string_view text) {
  const json message = parse(text);
  const Field root(&message, "");
  HaplyInventory inventory;
  // Only version 3.5 documents these two members. It also documents "vector" in the force command.
  bool vector = root.at("session_id").there();
  for (const Field& arm : root.at(std::string(kArms)).elements()) {
    inventory.arms.push_back(arm.at("device_id").id());
    vector = vector || arm.at("state").at("control_mode").there();
  }
  if (vector) inventory.force_field = HaplyForceField::kVector;
  for (const std::string_view kind : kGrips) {
    for (const Field& grip : root.at(std::string(kind)).elements()) {
      inventory.grips.push_back(grip.at("device_id").id());
    }
  }
  return inventory;
}

HaplySample read_haply_state(std::string_view text, const std::string& arm, const std::string& grip) {
  const json message = parse(text);
  const Field root(&message, "");
  const Field device = find(root.at(std::string(kArms)), arm);
  if (!device.there()) device.fail("in every message");
  HaplySample sample;
  const Field state = device.at("state");
  sample.state.position_D = state.at("cursor_position").vector();
  sample.state.velocity_D = state.at("cursor_velocity").vector();
  sample.state.gripper = 1.0;
  if (!grip.empty()) read_grip(root, grip, sample.state);
  sample.off = why_off(device.at("status"));
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
