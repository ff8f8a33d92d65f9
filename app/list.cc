// `palpate list`: the built-in names that flags and scenes accept.
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/inclusion.h"
#include "palpate/tissue.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/output.h"

namespace palpate::app {
namespace {

struct ListFlags {
  std::string kind;
  bool as_json = false;
};

/// A built-in name with a line about it.
struct Entry {
  std::string name;
  std::string description;
};

std::string size_of(const geometry::TriangleMesh& mesh) {
  const Vec3 size = geometry::bounds(mesh).size() / kMillimetre;
  return fmt::format("{} triangles, {:.0f} x {:.0f} x {:.0f} mm", mesh.triangles.size(), size.x(), size.y(),
                     size.z());
}

/// The name without its number of triangles: "heart" of "heart-30k".
std::string base_of(const std::string& name) {
  for (const std::string_view detail : {"-30k", "-300k"}) {
    if (name.ends_with(detail)) return name.substr(0, name.size() - detail.size());
  }
  return name;
}

/// "heart with about 30,000 triangles" of "heart-30k"
std::string finer(const std::string& name) {
  return base_of(name) + " with about " + (name.ends_with("-30k") ? "30,000" : "300,000") + " triangles";
}

std::vector<Entry> organs() {
  std::vector<Entry> all;
  for (const std::string& name : geometry::builtin_organ_names())
    all.push_back({name, base_of(name) == name ? size_of(geometry::make_organ(name)) : finer(name)});
  return all;
}

std::vector<Entry> tools() {
  std::vector<Entry> all;
  for (const std::string& name : geometry::builtin_tool_names()) {
    if (base_of(name) != name) {
      all.push_back({name, finer(name)});
      continue;
    }
    std::size_t triangles = 0;
    const geometry::Tool tool = geometry::make_tool(name);
    if (tool.needle) {
      all.push_back({name, "18G, 90 mm, bevel; or needle:SIZE,LENGTH_MM,TIP such as needle:0.9,120,pencil"});
      continue;
    }
    for (const geometry::ToolPart& part : tool.parts) triangles += part.mesh.triangles.size();
    all.push_back({name, fmt::format("two jaws and a shaft, {} triangles", triangles)});
  }
  all.push_back({"sphere:R", "a ball of R mm radius, such as sphere:3"});
  return all;
}

std::vector<Entry> tissues() {
  std::vector<Entry> all;
  for (const char* name : model::tissue_preset_names()) {
    const model::TissueParameters tissue = model::tissue_preset(name);
    std::string text = fmt::format("{} law, k1 {} N/m, beta {}, q {}", model::to_string(tissue.law),
                                   brief(tissue.k1), brief(tissue.beta), brief(tissue.q));
    if (tissue.max_depth) text += fmt::format(", valid to {} mm", brief(*tissue.max_depth / kMillimetre));
    if (!tissue.layers.empty()) text += "; layers for a needle:";
    for (const model::TissueLayer& layer : tissue.layers) text += " " + layer.name + ",";
    if (text.back() == ',') text.pop_back();
    if (tissue.source && !tissue.source->indenter.empty())
      text += "; measured with: " + tissue.source->indenter;
    all.push_back({name, text});
  }
  return all;
}

std::vector<Entry> devices() {
  static constexpr std::array<std::pair<std::string_view, const char*>, 10> kDescriptions{{
      {"scripted", "plays a tool path (scripted:PATH.csv), or its own press or pull"},
      {"replay", "plays the device samples of a recording (replay:REC.h5)"},
      {"emulated", "a hand and a device in software, for tests of stability"},
      {"mouse", "the mouse in the run's window or page (run --page)"},
      {"gamepad", "a gamepad in the run's window or page (run --page)"},
      {"forcedimension", "omega, delta and sigma of Force Dimension"},
      {"haply", "Inverse3 and VerseGrip of Haply"},
      {"touch", "Touch and Touch X of 3D Systems (Geomagic, Phantom)"},
      {"igtl", "poses that a client sends by OpenIGTLink (igtl:PORT/NAME)"},
      {"ros", "poses of a ROS 2 topic (ros:/TOPIC)"},
  }};
  std::vector<Entry> all;
  for (const scene::DeviceKind& kind : scene::device_kinds()) {
    if (kind.name == "host") continue;  // no run can open the host's device
    const auto* text = std::find_if(kDescriptions.begin(), kDescriptions.end(),
                                    [&kind](const auto& known) { return known.first == kind.name; });
    all.push_back({std::string(kind.name), text == kDescriptions.end() ? "" : text->second});
  }
  return all;
}

std::vector<Entry> inclusions() {
  std::vector<Entry> all;
  for (const model::InclusionPreset& preset : model::inclusion_presets()) {
    std::string text = fmt::format("radius {} mm, {} times as stiff as the tissue, centre {} mm deep",
                                   brief(preset.inclusion.radius / kMillimetre),
                                   brief(preset.inclusion.ratio), brief(preset.depth / kMillimetre));
    if (preset.inclusion.pulse > 0.0) text += ", pulsates";
    all.push_back({std::string(preset.name), text});
  }
  return all;
}

std::vector<Entry> scenes() {
  return {{"gallbladder press", "palpate run: curved forceps, the paper's first experiment"},
          {"heart pull", "palpate run --task pull: straight forceps, the paper's second experiment"},
          {"gallbladder palpate", "palpate run --task palpate: search for hidden lumps"},
          {"box insert", "palpate run --task insert: a needle goes through skin, fat and muscle"}};
}

std::vector<Entry> tasks() {
  return {{"press", "press the organ from outside"},
          {"pull", "grip the organ and pull it"},
          {"palpate", "find hidden lumps by touch; palpate score scores the search"},
          {"insert", "push a needle through layers of tissue; palpate score scores the insertion"}};
}

struct Kind {
  const char* name;
  const char* use;  // what takes the names
  std::vector<Entry> (*entries)();
};
constexpr std::array<Kind, 7> kListed{{{"organs", "--organ NAME, or mesh in [organ]", organs},
                                       {"tissues", "--tissue NAME, or tissue in [organ]", tissues},
                                       {"tools", "--tool NAME, or mesh in [tool]", tools},
                                       {"devices", "--device NAME, or kind in [device]", devices},
                                       {"inclusions", "--inclusion NAME", inclusions},
                                       {"scenes", "run without a scene file", scenes},
                                       {"tasks", "--task NAME, or task in [scene]", tasks}}};

void print_kind(const Kind& kind, const std::vector<Entry>& entries) {
  std::size_t width = 0;
  for (const Entry& entry : entries) width = std::max(width, entry.name.size());
  std::cout << kind.name << " (" << kind.use << ")\n";
  for (const Entry& entry : entries) {
    std::cout << fmt::format("  {:<{}}  {}\n", entry.name, width, entry.description);
  }
}

int list(const ListFlags& flags) {
  std::vector<std::string> names;
  for (const Kind& kind : kListed) names.emplace_back(kind.name);
  if (!flags.kind.empty() && std::find(names.begin(), names.end(), flags.kind) == names.end()) {
    const std::string near = nearest_word(flags.kind, names);
    throw InputError("list " + flags.kind + ": must be " + joined(names) +
                     (near.empty() ? "" : "; did you mean " + near + "?"));
  }
  nlohmann::ordered_json json;
  bool first = true;
  for (const Kind& kind : kListed) {
    if (!flags.kind.empty() && flags.kind != kind.name) continue;
    const std::vector<Entry> entries = kind.entries();
    if (flags.as_json) {
      json[kind.name] = nlohmann::ordered_json::array();
      for (const Entry& entry : entries)
        json[kind.name].push_back({{"name", entry.name}, {"description", entry.description}});
      continue;
    }
    if (!first) std::cout << '\n';
    first = false;
    print_kind(kind, entries);
  }
  if (flags.as_json) std::cout << json_text(json) << '\n';
  return kDone;
}

}  // namespace

void add_list(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ListFlags>();
  CLI::App* command =
      program.add_subcommand("list", "List the built-in organs, tissues, tools and other names");
  command->add_option("kind", flags->kind,
                      "organs, tissues, tools, devices, inclusions, scenes or tasks (default: all)");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer("Example: palpate list tissues");
  command->callback([flags, &exit_code] { exit_code = list(*flags); });
}

}  // namespace palpate::app
