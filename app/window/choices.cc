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

std::string noise_text(const noise::NoiseSettings& noise) {
  if (!noise.enabled) return "off";
  return fmt::format("{:.1f} mN", 1e3 * noise.gain / noise.threshold);
}

}  // namespace

OrganName parts_of(std::string_view name) {
  const std::size_t dash = std::min(name.find('-'), name.size());
  return {std::string(name.substr(0, dash)), std::string(name.substr(dash))};
}

std::vector<std::string> organ_choices() {
  std::vector<std::string> organs;
  for (const std::string& name : geometry::builtin_organ_names()) {
    std::string organ = parts_of(name).organ;
    if (std::find(organs.begin(), organs.end(), organ) == organs.end()) organs.push_back(std::move(organ));
  }
  return organs;
}

std::vector<std::string> detail_choices(std::string_view organ) {
  std::vector<std::string> details;
  for (const std::string& name : geometry::builtin_organ_names()) {
    OrganName parts = parts_of(name);
    if (parts.organ == organ) details.push_back(std::move(parts.detail));
  }
  std::sort(details.begin(), details.end(),
            [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  return details;
}

std::string detail_text(std::string_view detail) {
  if (detail.empty()) return "a few thousand triangles";
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
