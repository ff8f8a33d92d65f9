// palpate inspect: what a mesh is, what was repaired on reading it and what could not be.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/base/units.h"
#include "palpate/geometry/builtin.h"
#include "palpate/geometry/read_mesh.h"

#include "app/commands.h"
#include "app/messages.h"

namespace palpate::app {
namespace {

struct InspectOptions {
  std::string mesh;
  std::string unit;
  bool as_json = false;
};

constexpr double kCubicMillimetresPerCubicMetre = 1e9;

/// A path has a '/' or an ending; otherwise it is a built-in name.
bool is_path(const std::string& mesh) { return mesh.find_first_of("/.") != std::string::npos; }

geometry::LoadedMesh load(const InspectOptions& options) {
  if (is_path(options.mesh)) {
    const LengthUnit unit = options.unit.empty() ? LengthUnit::kMillimetre : parse_length_unit(options.unit);
    return geometry::read_mesh(options.mesh, unit);
  }
  if (!options.unit.empty()) {
    throw InputError("--unit: " + options.mesh + " is a built-in mesh and has its unit; leave the flag out");
  }
  geometry::LoadedMesh loaded{geometry::make_organ(options.mesh), {}};
  loaded.findings = geometry::findings_of(loaded.mesh);
  return loaded;
}

std::optional<double> volume_mm3(const geometry::MeshFindings& findings) {
  if (!findings.closed) return std::nullopt;  // an open surface encloses nothing
  return findings.volume * kCubicMillimetresPerCubicMetre;
}

void print_json(const geometry::LoadedMesh& loaded) {
  const geometry::Bounds box = geometry::bounds(loaded.mesh);
  const auto in_mm = [](const Vec3& p) {
    return std::vector<double>{p.x() / kMillimetre, p.y() / kMillimetre, p.z() / kMillimetre};
  };
  nlohmann::ordered_json json;
  json["vertices"] = loaded.mesh.vertices.size();
  json["triangles"] = loaded.mesh.triangles.size();
  json["closed"] = loaded.findings.closed;
  json["manifold"] = loaded.findings.manifold;
  json["shells"] = loaded.findings.shells;
  json["bbox_mm"] = {in_mm(box.low), in_mm(box.high)};
  const std::optional<double> volume = volume_mm3(loaded.findings);
  json["volume_mm3"] = volume ? nlohmann::ordered_json(*volume) : nlohmann::ordered_json(nullptr);
  json["repairs"] = loaded.findings.repairs;
  json["defects"] = loaded.findings.defects;
  std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void print_list(const char* name, const std::vector<std::string>& words) {
  std::string label = name;
  label.resize(14, ' ');
  if (words.empty()) std::cout << "  " << label << "none\n";
  for (const std::string& word : words) {
    std::cout << "  " << label << word << '\n';
    label.assign(label.size(), ' ');
  }
}

void print_table(const InspectOptions& options, const geometry::LoadedMesh& loaded) {
  const geometry::MeshFindings& findings = loaded.findings;
  const geometry::Bounds box = geometry::bounds(loaded.mesh);
  const auto side = [&](int k) {
    return shortest(box.low[k] / kMillimetre) + " .. " + shortest(box.high[k] / kMillimetre) + " mm";
  };
  const auto row = [](const std::string& name, const std::string& value) {
    std::string label = name;
    label.resize(14, ' ');
    std::cout << "  " << label << value << '\n';
  };
  std::cout << options.mesh << '\n';
  row("vertices", std::to_string(loaded.mesh.vertices.size()));
  row("triangles", std::to_string(loaded.mesh.triangles.size()));
  row("closed", findings.closed ? "yes" : "no");
  row("manifold", findings.manifold ? "yes" : "no");
  row("shells", std::to_string(findings.shells));
  row("x", side(0));
  row("y", side(1));
  row("z", side(2));
  const std::optional<double> volume = volume_mm3(findings);
  row("volume", volume ? shortest(*volume) + " mm^3" : "none: not closed");
  print_list("repaired", findings.repairs);
  print_list("left as it is", findings.defects);
}

}  // namespace

void add_inspect(CLI::App& program, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("inspect", "What a mesh is, what was repaired and what could not be");
  auto options = std::make_shared<InspectOptions>();
  command
      ->add_option(
          "mesh", options->mesh,
          "a file (.stl .obj .ply .off .3ds .gltf .glb) or a built-in organ (gallbladder, heart, ball, box)")
      ->required();
  command->add_option("--unit", options->unit,
                      "unit of the file's numbers: mm, cm, m or in; without it mm is taken");
  command->add_flag("--json", options->as_json, "one JSON document");
  command->footer("Example: palpate inspect liver.stl --unit mm --json");
  command->callback([options, &exit_code] {
    const geometry::LoadedMesh loaded = load(*options);
    if (is_path(options->mesh) && options->unit.empty()) {
      tell(options->mesh + ": no --unit given: its numbers are taken as mm");
    }
    if (options->as_json) {
      print_json(loaded);
    } else {
      print_table(*options, loaded);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
