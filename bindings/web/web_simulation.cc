// Functions of palpate_web.h for a simulation.
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/core.h>
#include <malloc.h>

#include "io/scene/builtin_scenes.h"
#include "palpate/tissue.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/web/palpate_web.h"

using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::UseError;

namespace {

template <typename Field>
constexpr const char* type_name() {
  using One = std::remove_all_extents_t<Field>;
  if constexpr (std::is_same_v<One, double>) return "f64";
  if constexpr (std::is_same_v<One, std::uint64_t>) return "u64";
  if constexpr (std::is_same_v<One, std::int32_t>) return "i32";
  if constexpr (std::is_same_v<One, const char*>) return "text";
  return "u32";  // uint32_t, size_t
}

template <typename Field>
std::string field_text(const char* name, std::size_t offset) {
  const std::size_t count = sizeof(Field) / sizeof(std::remove_all_extents_t<Field>);
  return std::string("[\"") + name + "\",\"" + type_name<Field>() + "\"," + std::to_string(offset) + "," +
         std::to_string(count) + "],";
}

#define PALPATE_FIELD(name) field_text<decltype(Struct::name)>(#name, offsetof(Struct, name))

std::string struct_text(const char* name, std::size_t size, std::string fields) {
  fields.pop_back();
  return std::string("\"") + name + "\":{\"size\":" + std::to_string(size) + ",\"fields\":[" + fields + "]},";
}

std::string sample_text() {
  using Struct = palpate_sample;
  return struct_text("sample", sizeof(Struct),
                     PALPATE_FIELD(position) + PALPATE_FIELD(orientation) + PALPATE_FIELD(velocity) +
                         PALPATE_FIELD(gripper) + PALPATE_FIELD(age) + PALPATE_FIELD(buttons) +
                         PALPATE_FIELD(fault));
}

/// The first field; the others follow as the class Result of palpate.js has them.
std::string result_text() {
  using Struct = palpate_result;
  return struct_text("result", sizeof(Struct), PALPATE_FIELD(tick));
}

std::string options_text() {
  using Struct = palpate_options;
  return struct_text("options", sizeof(Struct),
                     PALPATE_FIELD(scene_text) + PALPATE_FIELD(scene_folder) + PALPATE_FIELD(task) +
                         PALPATE_FIELD(record_file) + PALPATE_FIELD(record_waits) + PALPATE_FIELD(no_hand) +
                         PALPATE_FIELD(no_cache) + PALPATE_FIELD(surface_edge) +
                         field_text<std::uint32_t>("progress", offsetof(Struct, progress)));
}

std::string info_text() {
  using Struct = palpate_info;
  return struct_text("info", sizeof(Struct),
                     PALPATE_FIELD(hands) + PALPATE_FIELD(held) + PALPATE_FIELD(rate) +
                         PALPATE_FIELD(max_force) + PALPATE_FIELD(max_torque) + PALPATE_FIELD(seed) +
                         PALPATE_FIELD(scripted_ticks) + PALPATE_FIELD(vertices) + PALPATE_FIELD(triangles) +
                         PALPATE_FIELD(remarks));
}

std::string inclusion_text() {
  using Struct = palpate_inclusion;
  return struct_text("inclusion", sizeof(Struct),
                     PALPATE_FIELD(position) + PALPATE_FIELD(radius) + PALPATE_FIELD(stiffness_ratio) +
                         PALPATE_FIELD(name) + PALPATE_FIELD(visible));
}

std::string picture_text() {
  using Struct = palpate_picture;
  return struct_text("picture", sizeof(Struct),
                     PALPATE_FIELD(tick) + PALPATE_FIELD(organ_position) + PALPATE_FIELD(organ_orientation) +
                         PALPATE_FIELD(tool_position) + PALPATE_FIELD(tool_orientation) +
                         PALPATE_FIELD(gripper));
}

std::string response_text() {
  using Struct = palpate_response;
  return struct_text("response", sizeof(Struct),
                     PALPATE_FIELD(depth) + PALPATE_FIELD(force) + PALPATE_FIELD(stiffness) +
                         PALPATE_FIELD(cutoff_layer) + PALPATE_FIELD(saturated));
}

#undef PALPATE_FIELD

/// A text as JSON has it.
std::string json_text(std::string_view text) {
  std::string all = "\"";
  for (const char one : text) {
    if (one == '"' || one == '\\') {
      all += '\\';
      all += one;
    } else if (static_cast<unsigned char>(one) < 0x20) {
      all += fmt::format("\\u{:04x}", static_cast<unsigned>(one));
    } else {
      all += one;
    }
  }
  return all + '"';
}

std::string scenes_text() {
  std::string all = "[";
  for (const palpate::scene::BuiltinScene& one : palpate::scene::builtin_scenes()) {
    if (all.size() > 1) all += ',';
    all += fmt::format(R"({{"name":{},"title":{},"line":{},"toml":{}}})", json_text(one.name),
                       json_text(one.title), json_text(one.line), json_text(one.toml));
  }
  return all + "]";
}

std::string description_of(const palpate::scene::Scene& scene) {
  std::string tools;
  bool jaws = false;
  for (const palpate::geometry::Tool& tool : scene.tools) {
    tools += (tools.empty() ? "" : ",") + json_text(tool.name);
    for (const palpate::geometry::ToolPart& part : tool.parts) jaws = jaws || part.is_jaw;
  }
  const auto lumps = std::count_if(scene.inclusions.begin(), scene.inclusions.end(),
                                   [](const palpate::scene::InclusionSetup& one) { return !one.visible; });
  return fmt::format(
      R"({{"task":"{}","organ":{},"tissue":{},"tools":[{}],"jaws":{},"lumps":{},"tolerance":{}}})",
      palpate::scene::to_string(scene.task), json_text(scene.organ_name), json_text(scene.tissue.name), tools,
      jaws, lumps, scene.search.tolerance);
}

std::optional<std::string> given(const char* text) {
  return text == nullptr ? std::nullopt : std::optional<std::string>(text);
}

std::optional<std::uint64_t> seed_of(const char* text) {
  if (text == nullptr) return std::nullopt;
  std::uint64_t seed = 0;
  const char* end = text + std::strlen(text);
  if (const auto [last, error] = std::from_chars(text, end, seed); error != std::errc{} || last != end) {
    throw palpate::InputError(fmt::format("seed = {}: must be a whole number >= 0", text));
  }
  return seed;
}

}  // namespace

extern "C" {

const char* palpate_web_layout(void) {
  static const std::string text = [] {
    std::string all = "{" + options_text() + info_text() + sample_text() + result_text() + inclusion_text() +
                      picture_text() + response_text();
    all.back() = '}';
    return all;
  }();
  return text.c_str();
}

const char* palpate_web_scenes(void) {
  static const std::string text = scenes_text();
  return text.c_str();
}

const char* palpate_web_tissues(void) {
  static const std::string text = [] {
    std::string all;
    for (const char* name : palpate::model::tissue_preset_names())
      all += (all.empty() ? "[" : ",") + json_text(name);
    return all + "]";
  }();
  return text.c_str();
}

palpate_status palpate_web_open(const palpate_options* options, const char* organ, const char* organ_unit,
                                const char* tissue, const char* device, const char* seed,
                                palpate_simulation** simulation) {
  return guarded([&] {
    *simulation = nullptr;
    palpate::scene::Overrides request = palpate::c_interface::request_of(*options);
    request.organ = given(organ);
    request.organ_unit = given(organ_unit);
    request.tissue = given(tissue);
    request.device = given(device);
    request.seed = seed_of(seed);
    *simulation =
        std::make_unique<palpate_simulation>(palpate::c_interface::load(*options, request), *options)
            .release();
  });
}

const char* palpate_web_describe(const palpate_simulation* simulation) {
  static std::string text;
  text = description_of(simulation->scene());
  return text.c_str();
}

size_t palpate_web_snapshot_size(void) { return sizeof(palpate::haptics::Snapshot); }

palpate_status palpate_web_snapshot(palpate_simulation* simulation, void* bytes, size_t capacity) {
  return guarded([&] {
    require_given(simulation, "simulation");
    require_given(bytes, "bytes");
    if (capacity != sizeof(palpate::haptics::Snapshot)) {
      throw UseError("capacity: must be palpate_web_snapshot_size()");
    }
    std::memcpy(bytes, static_cast<const void*>(&simulation->newest_snapshot()), capacity);
  });
}

palpate_status palpate_web_flush_recording(palpate_simulation* simulation) {
  return guarded([&] { simulation->flush_recording(); });
}

size_t palpate_web_memory_in_use(void) { return static_cast<std::size_t>(mallinfo().uordblks); }
}
