#include "net/live_protocol.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "palpate/touch_noise.h"
#include "palpate/units.h"

namespace palpate::net {
namespace {

using nlohmann::json;

constexpr int kDeepest = 8;                 // nesting levels of a message; the commands need three
constexpr std::size_t kLongestText = 1024;  // bytes of a text value, such as a path
constexpr std::size_t kLongestName = 63;    // bytes of a tissue's name, as in a recorded parameter update
constexpr std::size_t kLongestId = 64;      // bytes
constexpr double kLargestWhole = 9007199254740992.0;  // 2^53; JSON readers round larger integers

[[noreturn]] void fail(const std::string& field, const json& value, const std::string& want) {
  throw LiveError("field",
                  field + " = " + ascii_excerpt(value.dump(-1, ' ', false, json::error_handler_t::replace)) +
                      ": must be " + want,
                  field);
}

/// Reads an object of a message key by key. allow_no_more() refuses the keys that were not read.
class Members final {
 public:
  /// @param path name of the object in the message; empty for the message itself
  Members(const json& object, std::string path) : object_(object), path_(std::move(path)) {
    if (!object_.is_object()) fail(path_.empty() ? "message" : path_, object_, "an object");
  }

  [[nodiscard]] std::string path_of(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }
  [[nodiscard]] const json* find(const std::string& key) {
    known_.push_back(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }
  [[nodiscard]] Members required_object(const std::string& key, const std::string& want) {
    const json* value = find(key);
    if (value == nullptr) throw LiveError("field", path_of(key) + ": missing, must be " + want, path_of(key));
    return {*value, path_of(key)};
  }
  [[nodiscard]] std::optional<double> number(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr) return std::nullopt;
    if (!value->is_number()) fail(path_of(key), *value, "a finite number");
    return value->get<double>();
  }
  [[nodiscard]] double required_number(const std::string& key) {
    const std::optional<double> value = number(key);
    if (!value) throw LiveError("field", path_of(key) + ": missing, must be a finite number", path_of(key));
    return *value;
  }
  [[nodiscard]] std::optional<bool> flag(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr) return std::nullopt;
    if (!value->is_boolean()) fail(path_of(key), *value, "true or false");
    return value->get<bool>();
  }
  [[nodiscard]] std::optional<std::string> text(const std::string& key, std::size_t longest) {
    const json* value = find(key);
    if (value == nullptr) return std::nullopt;
    const std::string want =
        "a text of 1 to " + std::to_string(longest) + " bytes without control characters";
    if (!value->is_string()) fail(path_of(key), *value, want);
    const auto& read = value->get_ref<const std::string&>();
    const bool plain = std::none_of(
        read.begin(), read.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
    if (read.empty() || read.size() > longest || !plain) fail(path_of(key), *value, want);
    return read;
  }
  /// Refuses a key that was not read. @throws LiveError
  void allow_no_more() const {
    for (const auto& [key, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      const std::string near = nearest_word(key, known_);
      throw LiveError("field",
                      path_of(ascii_excerpt(key)) + ": is no field of this command" +
                          (near.empty() ? "" : ", did you mean " + near + "?"),
                      path_of(ascii_excerpt(key)));
    }
  }

 private:
  const json& object_;
  std::string path_;
  std::vector<std::string> known_;
};

json parse(std::string_view text) {
  if (text.size() > kLargestRequest) {
    throw LiveError("json", "message: has " + std::to_string(text.size()) + " bytes, must have at most " +
                                std::to_string(kLargestRequest));
  }
  json message;
  try {
    message = parse_json(text, kDeepest);
  } catch (const InputError& error) {
    throw LiveError("json", std::string("message: ") + error.what());
  }
  if (message.is_object()) return message;
  throw LiveError("json", "message: must be a JSON object, such as {\"do\": \"state\"}");
}

TissueEdit read_tissue(Members& root) {
  TissueEdit edit;
  Members tissue = root.required_object("tissue", "an object of the tissue's new values");
  edit.preset = tissue.text("preset", kLongestName);
  edit.name = tissue.text("name", kLongestName);
  if (const json* law = tissue.find("law"); law != nullptr) {
    if (*law != "layered" && *law != "smooth") fail("tissue.law", *law, "\"layered\" or \"smooth\"");
    edit.law = model::parse_law(law->get_ref<const std::string&>());
  }
  std::map<std::string_view, Members> sections;
  for (const model::TissueSection& section : model::kTissueSections) {
    if (const json* found = tissue.find(std::string(section.key)); found != nullptr) {
      sections.emplace(section.key, Members(*found, "tissue." + std::string(section.key)));
    }
  }
  for (const model::TissueField& field : model::kTissueFields) {
    const auto found = sections.find(field.section);
    if (!field.section.empty() && found == sections.end()) continue;
    Members& from = field.section.empty() ? tissue : found->second;
    const json* value = from.find(field.key);
    if (value == nullptr) continue;
    if (field.optional() && value->is_null()) {
      edit.numbers.emplace_back(&field, std::nullopt);
    } else {
      edit.numbers.emplace_back(&field, from.required_number(field.key) * field.unit.si);
    }
  }
  if (const json* terms = tissue.find("relaxation"); terms != nullptr) {
    if (!terms->is_array() || terms->size() > model::kMaxRelaxationTerms) {
      fail("tissue.relaxation", *terms, "an array of at most three {\"share\": ..., \"time_s\": ...}");
    }
    edit.relaxation.emplace();
    for (std::size_t i = 0; i < terms->size(); ++i) {
      Members term((*terms)[i], "tissue.relaxation[" + std::to_string(i) + "]");
      model::RelaxationTerm read;
      read.g = term.required_number("share");
      read.tau = term.required_number("time_s");
      edit.relaxation->push_back(read);
      term.allow_no_more();
    }
  }
  for (const auto& [name, section] : sections) section.allow_no_more();
  tissue.allow_no_more();
  return edit;
}

NoiseEdit read_noise(Members& root) {
  NoiseEdit edit;
  Members noise = root.required_object("noise", "an object of the noise's new values");
  edit.enabled = noise.flag("enabled");
  edit.gain = noise.number("gain_N_m");
  edit.threshold = noise.number("threshold_mm");
  if (edit.threshold) *edit.threshold *= kMillimetre;
  edit.user_threshold = noise.number("user_threshold_N");
  edit.share = noise.number("share_of_threshold");
  noise.allow_no_more();
  if (edit.user_threshold.has_value() != edit.share.has_value() || (edit.share && edit.gain)) {
    throw LiveError("field",
                    "noise: give gain_N_m, or user_threshold_N and share_of_threshold, which set it together",
                    "noise.share_of_threshold");
  }
  return edit;
}

std::uint32_t read_number(const json& value, const std::string& path) {
  const double number = value.is_number() ? value.get<double>() : 0.0;
  if (!(number >= 1.0 && number <= static_cast<double>(model::kMaxInclusions)) ||
      number != std::floor(number)) {
    fail(path, value, "a whole number from 1 to " + std::to_string(model::kMaxInclusions));
  }
  return static_cast<std::uint32_t>(number);
}

Vec3 read_vector(const json& value, const std::string& path) {
  const bool numbers = value.is_array() && value.size() == 3 &&
                       std::all_of(value.begin(), value.end(), [](const json& n) { return n.is_number(); });
  if (!numbers) fail(path, value, "an array of three numbers");
  return Vec3(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
}

InclusionEdit read_inclusion(Members& root) {
  InclusionEdit edit;
  Members inclusion =
      root.required_object("inclusion", "an object with name or number, and the inclusion's new values");
  edit.name = inclusion.text("name", kLongestText);
  if (const json* number = inclusion.find("number")) {
    edit.number = read_number(*number, inclusion.path_of("number"));
  }
  if (const json* position = inclusion.find("position_mm")) {
    edit.centre_S = read_vector(*position, inclusion.path_of("position_mm")) * kMillimetre;
  }
  edit.ratio = inclusion.number("stiffness_ratio");
  inclusion.allow_no_more();
  if (edit.name.has_value() == edit.number.has_value()) {
    throw LiveError("field", "inclusion: must have name or number, and not both", "inclusion.name");
  }
  return edit;
}

std::vector<std::string> read_presets(Members& root) {
  const json* value = root.find("inclusions");
  if (value == nullptr) return {};
  const bool texts =
      value->is_array() && value->size() <= model::kMaxInclusions &&
      std::all_of(value->begin(), value->end(), [](const json& preset) {
        return preset.is_string() && preset.get_ref<const std::string&>().size() < kLongestName;
      });
  if (!texts) {
    fail("inclusions", *value,
         "an array of at most " + std::to_string(model::kMaxInclusions) + " names, such as [\"nodule\"]");
  }
  if (value->empty()) return {"none"};
  return value->get<std::vector<std::string>>();
}

Hello read_hello(Members& root) {
  const json* version = root.find("palpate");
  if (version == nullptr || *version != kLiveProtocol) {
    throw LiveError(
        "version",
        "palpate" + (version == nullptr ? ": missing" : " = " + ascii_excerpt(version->dump(-1, ' ', true))) +
            ": must be \"" + kLiveProtocol + "\", the protocol's version that this program speaks",
        "palpate");
  }
  return {root.text("token", kLongestText).value_or("")};
}

Stream read_stream(Members& root) {
  const double rate = root.required_number("rate_Hz");
  if (!(rate == 0.0 || (rate >= 0.1 && rate <= kFastestStream))) {
    throw LiveError(
        "field",
        "rate_Hz = " + shortest(rate) + ": must be 0 (no stream) or 0.1 to " + shortest(kFastestStream),
        "rate_Hz");
  }
  return {rate};
}

std::uint32_t read_hand(Members& root) {
  const double hand = root.number("hand").value_or(0.0);
  if (!(hand >= 0.0 && hand < kMaxHands) || hand != std::floor(hand)) {
    throw LiveError("field", "hand = " + shortest(hand) + ": must be the number of a hand, from 0", "hand");
  }
  return static_cast<std::uint32_t>(hand);
}

Record read_record(Members& root) {
  const std::optional<bool> on = root.flag("on");
  if (!on) throw LiveError("field", "on: missing, must be true or false", "on");
  return {*on};
}

geometry::Ray read_ray(const json& value) {
  constexpr double kFarthest = 100.0;  // m
  Members ray(value, "ray");
  const auto vector = [&ray](const char* key) {
    const json* found = ray.find(key);
    return found == nullptr ? Vec3(Vec3::Zero()) : read_vector(*found, ray.path_of(key));
  };
  geometry::Ray read{vector("origin_m"), vector("direction")};
  ray.allow_no_more();
  if (!(read.origin.cwiseAbs().maxCoeff() <= kFarthest))
    fail("ray.origin_m", value["origin_m"], "within 100 m");
  const double length = read.direction.norm();
  if (!(length > 0.5 && length < 2.0)) fail("ray", value, "origin_m and a direction of length 1");
  read.direction /= length;
  return read;
}

SteerMouse read_mouse(Members& root) {
  SteerMouse mouse;
  mouse.hand = read_hand(root);
  if (const json* ray = root.find("ray")) {
    mouse.elsewhere = ray->is_null();
    if (!mouse.elsewhere) mouse.ray_W = read_ray(*ray);
  }
  mouse.deeper = root.number("deeper_mm").value_or(0.0) * kMillimetre;
  mouse.grip = root.flag("grip");
  mouse.park = root.flag("park");
  return mouse;
}

SteerGamepad read_gamepad(Members& root) {
  SteerGamepad pad;
  const auto share = [&root](const char* key, double most) {
    const double value = root.number(key).value_or(0.0);
    if (!(value >= 0.0 && value <= most)) fail(key, value, "0 to " + shortest(most));
    return value;
  };
  pad.hand = read_hand(root);
  if (const json* way = root.find("way")) {
    pad.way_W = read_vector(*way, "way");
    if (!(pad.way_W.norm() <= 2.0)) fail("way", *way, "no longer than 2");
  }
  pad.press = share("press", 1.0);
  pad.close = share("close", 1.0);
  pad.buttons = static_cast<std::uint32_t>(share("buttons", 15.0));
  return pad;
}

Load read_load(Members& root) {
  Load load;
  load.scene = root.text("scene", kLongestText);
  load.task = root.text("task", kLongestText);
  load.organ = root.text("organ", kLongestText);
  load.organ_unit = root.text("organ_unit", kLongestText);
  load.inclusions = read_presets(root);
  load.tissue = root.text("tissue", kLongestText);
  load.tool = root.text("tool", kLongestText);
  load.tool_unit = root.text("tool_unit", kLongestText);
  load.device = root.text("device", kLongestText);
  load.rate_Hz = root.number("rate_Hz");
  if (const std::optional<double> seed = root.number("seed")) {
    if (!(*seed >= 0.0 && *seed <= kLargestWhole) || *seed != std::floor(*seed)) {
      throw LiveError("field", "seed = " + shortest(*seed) + ": must be a whole number from 0 to 2^53",
                      "seed");
    }
    load.seed = static_cast<std::uint64_t>(*seed);
  }
  load.no_noise = root.flag("no_noise").value_or(false);
  return load;
}

using Reader = std::function<LiveCommand(Members&)>;

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{
      {"hello", [](Members& root) { return LiveCommand(read_hello(root)); }},
      {"version", [](Members&) { return LiveCommand(GetVersion{}); }},
      {"state", [](Members&) { return LiveCommand(GetState{}); }},
      {"scene", [](Members&) { return LiveCommand(GetScene{}); }},
      {"surface",
       [](Members& root) { return LiveCommand(GetSurface{root.flag("at_rest").value_or(false)}); }},
      {"tool", [](Members& root) { return LiveCommand(GetTool{read_hand(root)}); }},
      {"picture", [](Members&) { return LiveCommand(GetPicture{}); }},
      {"stream", [](Members& root) { return LiveCommand(read_stream(root)); }},
      {"load", [](Members& root) { return LiveCommand(read_load(root)); }},
      {"start", [](Members& root) { return LiveCommand(Start{root.text("device", kLongestText)}); }},
      {"stop", [](Members&) { return LiveCommand(Stop{}); }},
      {"devices", [](Members&) { return LiveCommand(GetDevices{}); }},
      {"record", [](Members& root) { return LiveCommand(read_record(root)); }},
      {"mouse", [](Members& root) { return LiveCommand(read_mouse(root)); }},
      {"gamepad", [](Members& root) { return LiveCommand(read_gamepad(root)); }},
      {"set_tissue", [](Members& root) { return LiveCommand(SetTissue{read_tissue(root)}); }},
      {"set_noise", [](Members& root) { return LiveCommand(SetNoise{read_noise(root)}); }},
      {"set_inclusion", [](Members& root) { return LiveCommand(SetInclusion{read_inclusion(root)}); }},
      {"reset_faults", [](Members&) { return LiveCommand(ResetFaults{}); }},
  };
  return all;
}

std::string read_id(Members& root) {
  const json* id = root.find("id");
  if (id == nullptr) return {};
  std::string text;
  if (id->is_string() || id->is_number_integer()) text = id->dump(-1, ' ', true);
  if (text.empty() || text.size() > kLongestId) {
    fail("id", *id, "a text or whole number of at most " + std::to_string(kLongestId) + " bytes as JSON");
  }
  return text;
}

const Reader& find_reader(const json& command) {
  std::vector<std::string> names;
  for (const auto& [name, reader] : readers()) names.push_back(name);
  if (command.is_string()) {
    const auto found = readers().find(command.get_ref<const std::string&>());
    if (found != readers().end()) return found->second;
  }
  const std::string near =
      command.is_string() ? nearest_word(command.get_ref<const std::string&>(), names) : std::string();
  throw LiveError("command",
                  "do = " + ascii_excerpt(command.dump(-1, ' ', true)) + ": must be one of " + joined(names) +
                      (near.empty() ? "" : "; did you mean " + near + "?"),
                  "do");
}

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::vector<scene::InclusionSetup>& inclusions, const std::string& field,
                         const std::string& value) {
  std::string visible;
  for (std::size_t i = 0; i < inclusions.size(); ++i) {
    if (!inclusions[i].visible) continue;
    visible += (visible.empty() ? "" : ", ") + std::to_string(i + 1) + " (" + inclusions[i].name + ")";
  }
  throw LiveError("refused",
                  field + " = " + value + ": " +
                      (visible.empty() ? "the scene has no visible inclusion"
                                       : "must select one visible inclusion: " + visible),
                  field);
}

}  // namespace

LiveCommand read_live_message(std::string_view text, LiveReference& reference) {
  reference = {};
  const json message = parse(text);
  Members root(message, "");
  reference.id = read_id(root);
  const json* command = root.find("do");
  if (command == nullptr) {
    throw LiveError("command", "do: missing, must name a command, such as \"state\"", "do");
  }
  const Reader& reader = find_reader(*command);
  reference.command = command->get<std::string>();
  LiveCommand read = reader(root);
  root.allow_no_more();
  return read;
}

model::TissueParameters edited(model::TissueParameters tissue, const TissueEdit& edit) {
  if (edit.preset) tissue = model::tissue_preset(*edit.preset);
  if (edit.name) tissue.name = *edit.name;
  if (edit.law) tissue.law = *edit.law;
  if (edit.relaxation) tissue.relaxation = *edit.relaxation;
  for (const auto& [field, value] : edit.numbers) field->at.set(tissue, value);
  // An edited tissue is no longer the measured one, but a size exponent, now or later, needs its radius.
  const bool measured = edit.numbers.empty() && !edit.law && !edit.relaxation;
  if (!measured && tissue.source) tissue.source->indenter.clear();
  return tissue;
}

haptics::LiveNoise edited(haptics::LiveNoise noise, const NoiseEdit& edit) {
  if (edit.enabled) noise.enabled = *edit.enabled;
  if (edit.threshold) noise.threshold = *edit.threshold;
  if (edit.gain) noise.gain = *edit.gain;
  if (edit.user_threshold && edit.share) {
    noise.gain = noise::gain_from_threshold(*edit.user_threshold, *edit.share, noise.threshold);
  }
  return noise;
}

Json inclusion_json(const scene::InclusionSetup& inclusion, std::size_t index) {
  const Vec3 centre_mm = inclusion.inclusion.centre_S / kMillimetre;
  return {{"number", index + 1},
          {"name", inclusion.name},
          {"position_mm", {centre_mm.x(), centre_mm.y(), centre_mm.z()}},
          {"radius_mm", inclusion.inclusion.radius / kMillimetre},
          {"stiffness_ratio", inclusion.inclusion.ratio}};
}

Json inclusions_json(const std::vector<scene::InclusionSetup>& inclusions) {
  Json visible = Json::array();
  for (std::size_t i = 0; i < inclusions.size(); ++i) {
    if (inclusions[i].visible) visible.push_back(inclusion_json(inclusions[i], i));
  }
  const std::size_t hidden = inclusions.size() - visible.size();
  return {{"inclusions", visible}, {"hidden_inclusions", hidden}};
}

std::size_t find_inclusion(const std::vector<scene::InclusionSetup>& inclusions, const InclusionEdit& edit) {
  if (edit.number) {
    const std::size_t index = *edit.number - 1;
    if (index >= inclusions.size() || !inclusions[index].visible) {
      refuse(inclusions, "inclusion.number", std::to_string(*edit.number));
    }
    return index;
  }
  const std::string name = edit.name.value_or("");
  const auto has_name = [&name](const scene::InclusionSetup& one) { return one.visible && one.name == name; };
  const auto found = std::find_if(inclusions.begin(), inclusions.end(), has_name);
  if (std::count_if(inclusions.begin(), inclusions.end(), has_name) != 1) {
    refuse(inclusions, "inclusion.name", '"' + name + '"');
  }
  return static_cast<std::size_t>(found - inclusions.begin());
}

scene::InclusionSetup edited(scene::InclusionSetup inclusion, const InclusionEdit& edit) {
  if (edit.centre_S) inclusion.inclusion.centre_S = *edit.centre_S;
  if (edit.ratio) inclusion.inclusion.ratio = *edit.ratio;
  return inclusion;
}

}  // namespace palpate::net
