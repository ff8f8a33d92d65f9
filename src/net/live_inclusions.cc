#include "net/live_inclusions.h"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "palpate/units.h"

namespace palpate::net {
namespace {

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
