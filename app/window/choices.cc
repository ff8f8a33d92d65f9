#include "app/window/choices.h"

#include <algorithm>
#include <filesystem>

#include <fmt/core.h>

#include "palpate/builtin.h"

namespace palpate::app {
namespace {

constexpr const char* kPullTool = "straight-forceps";

bool has_jaws(const geometry::Tool& tool) {
  return std::any_of(tool.parts.begin(), tool.parts.end(),
                     [](const geometry::ToolPart& part) { return part.is_jaw; });
}

std::string short_text(const std::string& name) {
  const std::string file = std::filesystem::path(name).filename().string();
  return file.empty() ? name : file;
}

/// Each name once, without its detail.
std::vector<std::string> bases_of(const std::vector<std::string>& names) {
  std::vector<std::string> bases;
  for (const std::string& name : names) {
    std::string base = parts_of(name).base;
    if (std::find(bases.begin(), bases.end(), base) == bases.end()) bases.push_back(std::move(base));
  }
  return bases;
}

std::string noise_text(const noise::NoiseSettings& noise) {
  if (!noise.enabled) return "off";
  return fmt::format("{:.1f} mN", 1e3 * noise.gain / noise.threshold);
}

}  // namespace

BuiltinName parts_of(std::string_view name) {
  std::size_t end = name.size();
  for (const std::string_view detail : {"-30k", "-300k"}) {
    if (name.ends_with(detail)) end -= detail.size();
  }
  return {std::string(name.substr(0, end)), std::string(name.substr(end))};
}

std::vector<std::string> organ_choices() { return bases_of(geometry::builtin_organ_names()); }
std::vector<std::string> tool_choices() { return bases_of(geometry::builtin_tool_names()); }

std::vector<std::string> detail_choices(std::string_view base) {
  std::vector<std::string> details;
  for (const std::vector<std::string>* names :
       {&geometry::builtin_organ_names(), &geometry::builtin_tool_names()}) {
    for (const std::string& name : *names) {
      BuiltinName parts = parts_of(name);
      if (parts.base == base) details.push_back(std::move(parts.detail));
    }
  }
  std::sort(details.begin(), details.end(),
            [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  return details;
}

std::string detail_text(std::string_view detail, const char* coarsest) {
  if (detail.empty()) return coarsest;
  std::string number(detail.substr(1));  // "30k"
  if (!number.empty() && number.back() == 'k') number.replace(number.size() - 1, 1, ",000");
  return number + " triangles";
}

scene::Overrides with_task(const scene::Scene& scene, const scene::Overrides& request, scene::Task task) {
  scene::Overrides wanted = request;
  wanted.task = scene::to_string(task);
  const bool by_scene = request.scene || request.scene_text;
  if (!by_scene && !request.organ) wanted.organ = scene.organ_name;
  if (scene.tools.size() != 1) return wanted;
  if (task == scene::Task::kPull && !has_jaws(scene.tools.front())) {
    wanted.tools = {kPullTool};
    wanted.tool_unit.reset();
  } else if (task == scene::Task::kInsert && !scene.tools.front().needle) {
    wanted.tools = {"needle"};
    wanted.tool_unit.reset();
  } else if (!by_scene && request.tools.empty()) {
    wanted.tools = {scene.tools.front().name};
  }
  return wanted;
}

std::string changes_text(const Selection& before, const Selection& after) {
  std::string text;
  const auto add = [&text](const std::string& what) { text += (text.empty() ? "Now: " : ", ") + what; };
  const auto compare = [&add](const char* name, const std::string& was, const std::string& is) {
    if (was != is) add(name + (" " + short_text(is)) + " (before: " + short_text(was) + ")");
  };
  compare("task", before.task, after.task);
  compare("organ", before.organ, after.organ);
  compare("tool", before.tool, after.tool);
  compare("device", before.device, after.device);
  compare("tissue", before.tissue.name, after.tissue.name);
  if (before.tissue.name == after.tissue.name && before.tissue != after.tissue) {
    add("the scene's numbers of the tissue");
  }
  compare("touch noise", noise_text(before.noise), noise_text(after.noise));
  return text.empty() ? text : text + ".";
}

}  // namespace palpate::app
