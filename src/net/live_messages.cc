#include "net/live_messages.h"

#include <array>
#include <cstddef>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/haptics/gate.h"
#include "core/haptics/tick_fields.h"
#include "core/model/tissue_fields.h"
#include "io/system/json_text.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"

namespace palpate::net {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::uint32_t, const char*>, 13> kStatus{{
    {contact::kStartedInside, "started-inside"},
    {contact::kContactsFull, "contacts-full"},
    {contact::kGripReleased, "grip-released"},
    {contact::kJump, "jump"},
    {contact::kExtrapolated, "extrapolated"},
    {contact::kAtHub, "at-hub"},
    {haptics::kForceClamped, "force-clamped"},
    {haptics::kForceSlewed, "force-slewed"},
    {haptics::kTorqueClamped, "torque-clamped"},
    {haptics::kTorqueSlewed, "torque-slewed"},
    {haptics::kEnergyDamped, "energy-damped"},
    {haptics::kDutyHigh, "duty-high"},
    {haptics::kDutyLimited, "duty-limited"},
}};

Json status_json(std::uint32_t status) {
  Json names = Json::array();
  for (const auto& [bit, name] : kStatus) {
    if ((status & bit) != 0) names.push_back(name);
  }
  return names;
}

Json value_json(const haptics::TickRow& row, const haptics::TickField& field) {
  using haptics::TickRow;
  if (field.offset == offsetof(TickRow, phase)) return contact::kPhaseNames.at(row.phase);
  if (field.offset == offsetof(TickRow, saturated)) return row.saturated != 0;
  if (field.offset == offsetof(TickRow, status)) return status_json(row.status);
  if (field.offset == offsetof(TickRow, fault))
    return haptics::name_of(static_cast<haptics::Fault>(row.fault));
  Json numbers = Json::array();
  for (std::size_t i = 0; i < field.size(); ++i) {
    numbers.push_back(with_number(row, field.type, field.offset + i * column_size(field.type),
                                  [](auto number) { return Json(number); }));
  }
  return numbers.size() == 1 ? numbers.front() : numbers;
}

Json hand_json(const haptics::TickRow& row) {
  Json json = Json::object();
  for (const haptics::TickField& field : haptics::kTickFields) {
    if (field.live != nullptr) json[field.live] = value_json(row, field);
  }
  return json;
}

/// Members that every answer contains.
Json refer(const LiveReference& reference) {
  Json json = Json::object();
  json["answer"] = reference.command.empty() ? Json(nullptr) : Json(reference.command);
  if (!reference.id.empty()) json["id"] = parse_json(reference.id);
  return json;
}

}  // namespace

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json tissue_json(const model::TissueParameters& tissue) {
  Json json{{"name", tissue.name}, {"law", model::to_string(tissue.law)}};
  for (const model::TissueField& field : model::kTissueFields) {
    Json& table = field.section.empty() ? json : json[std::string(field.section)];
    const std::optional<double> value = field.at.get(tissue);
    table[field.key] = value ? Json(*value / field.unit.si) : Json(nullptr);
  }
  json["relaxation"] = Json::array();
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    json["relaxation"].push_back({{"share", term.g}, {"time_s", term.tau}});
  }
  return json;
}

Json noise_json(const haptics::LiveNoise& noise) {
  return {
      {"enabled", noise.enabled}, {"gain_N_m", noise.gain}, {"threshold_mm", noise.threshold / kMillimetre}};
}

Json scene_json(const scene::Scene& scene) {
  Json hands = Json::array();
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    hands.push_back({{"tool", scene.tools[hand].name}, {"device", scene.devices[hand].kind}});
  }
  Json motion = Json::array();
  for (const auto& one : scene.organ_motion) motion.push_back(model::to_string(one.kind));
  return {{"name", scene.name},
          {"task", scene::to_string(scene.task)},
          {"rate_Hz", scene.rate_Hz},
          {"seed", scene.seed},
          {"organ", scene.organ_name},
          {"organ_triangles", scene.organ.triangles.size()},
          {"organ_motion", motion},
          {"stiffness_map", !scene.stiffness.empty()},
          {"hands", hands},
          {"max_force_N", scene.safety.max_force},
          {"repairs", scene.repairs},
          {"remarks", scene.remarks}};
}

Json state_json(const LiveState& state) {
  const Quat& q = state.organ_W.rotation;
  const Vec3& p = state.organ_W.position;
  Json hands = Json::array();
  for (std::uint32_t hand = 0; hand < state.tick->hands; ++hand) {
    hands.push_back(hand_json(state.tick->rows[hand]));
  }
  return {{"run", state.run},
          {"tick", state.tick->tick},
          {"time_s", state.tick->rows[0].time},
          {"change", state.tick->change},
          {"ticks_per_s", state.rate_Hz ? Json(*state.rate_Hz) : Json(nullptr)},
          {"missed_deadlines", state.tick->missed},
          {"organ_m", {p.x(), p.y(), p.z()}},
          {"organ_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"hands", hands}};
}

std::string answer_text(const LiveReference& reference, const Json& members) {
  Json json = refer(reference);
  json.update(members);
  return text_of(json);
}

std::string error_text(const LiveReference& reference, const InputError& error) {
  Json json;
  const auto* live = dynamic_cast<const LiveError*>(&error);
  const auto* parameter = dynamic_cast<const ParameterError*>(&error);
  json["error"]["code"] = live != nullptr ? live->code() : "refused";
  const std::string field = live != nullptr        ? live->field()
                            : parameter != nullptr ? parameter->field()
                                                   : std::string();
  if (!field.empty()) json["error"]["field"] = field;
  json["error"]["words"] = error.what();
  json.update(refer(reference));
  return text_of(json);
}

std::string event_text(const std::string& name, const Json& members) {
  Json json{{"event", name}};
  json.update(members);
  return text_of(json);
}

std::string frame_text(const std::string& state, std::uint64_t left_out) {
  return fmt::format("{{\"left_out\":{},\"state\":{}}}", left_out, state);
}

}  // namespace palpate::net
