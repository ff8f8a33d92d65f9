// `palpate inspect`: describes a mesh and lists its repairs and the defects that cannot be repaired.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/repair/crossings.h"
#include "io/mesh_io/repair/repair.h"
#include "io/scene/plausibility.h"
#include "io/scene/support_reader.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"
#include "view/report/subject.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/session.h"

namespace palpate::app {
namespace {

struct InspectOptions {
  std::string mesh;
  std::string unit;
  std::vector<std::string> support;  // --organ-support
  std::filesystem::path screenshot;
  bool as_json = false;
};

constexpr double kCubicMillimetresPerCubicMetre = 1e9;
constexpr int kPictureHeight = 480;

/// A path contains a '/' or a '.'; anything else is the name of a built-in organ.
bool is_path(const std::string& mesh) { return mesh.find_first_of("/.") != std::string::npos; }

/// The mesh after the repairs of an organ. A mesh that cannot be an organ is shown as a tool would use it.
struct Inspected {
  mesh_io::LoadedMesh loaded;
  std::string refusal;        // why the mesh cannot be an organ; empty: it can
  std::string tool_refusal;   // why it cannot be a tool; empty: it can
  bool all_crossings = true;  // false: too many candidate pairs to test all
  std::optional<geometry::Support> support;
};

mesh_io::LoadedMesh load(const InspectOptions& options) {
  if (is_path(options.mesh)) {
    const LengthUnit unit = options.unit.empty() ? LengthUnit::kMillimetre : parse_length_unit(options.unit);
    return mesh_io::read_mesh(options.mesh, unit);
  }
  if (!options.unit.empty()) {
    throw InputError("--unit: " + options.mesh + " is a built-in mesh, whose unit is fixed; omit the flag");
  }
  mesh_io::LoadedMesh loaded{geometry::make_organ(options.mesh), {}};
  loaded.findings = mesh_io::findings_of(loaded.mesh);
  return loaded;
}

void check_screenshot(const InspectOptions& options) {
  require_png_file(options.screenshot, "--screenshot");
  if (!is_path(options.mesh)) return;
  std::vector<NamedFile> inputs = {{"the mesh", options.mesh}};
  for (const std::filesystem::path& buffer : mesh_io::gltf_buffer_files(options.mesh))
    inputs.push_back({"a buffer of the mesh", buffer});
  require_no_overwrite(std::vector<NamedFile>{{"--screenshot", options.screenshot}}, inputs);
}

std::string without_start(const std::string& text, const std::string& start) {
  return text.starts_with(start) ? text.substr(start.size()) : text;
}

Inspected inspect(const InspectOptions& options) {
  Inspected inspected{load(options), {}, {}, true, {}};
  try {
    mesh_io::require_tool(inspected.loaded, options.mesh);
  } catch (const InputError& error) {
    inspected.tool_refusal = without_start(error.what(), options.mesh + ": ");
  }
  try {
    inspected.loaded = mesh_io::repair_organ(inspected.loaded, options.mesh);
    const std::string distant =
        scene::organ_distance_remark(geometry::bounds(inspected.loaded.mesh), options.mesh);
    if (!distant.empty()) inspected.loaded.findings.remarks.push_back(distant);
  } catch (const InputError& error) {
    inspected.refusal =
        without_start(without_start(error.what(), options.mesh + ": "), "cannot be an organ: ");
  }
  if (const auto stated = scene::support_by_flags(options.support)) {
    if (!inspected.refusal.empty())
      throw InputError("--organ-support: " + options.mesh + " cannot be an organ: " + inspected.refusal);
    scene::check_support(*stated, inspected.loaded.mesh);
    inspected.support = stated->support;
  }
  if (!inspected.loaded.findings.crossing_pairs) {
    const mesh_io::Crossings crossings = mesh_io::find_crossings(inspected.loaded.mesh);
    inspected.loaded.findings.crossing_pairs = crossings.pairs.size();
    inspected.all_crossings = crossings.all;
  }
  return inspected;
}

std::optional<double> volume_mm3(const mesh_io::MeshFindings& findings) {
  if (!findings.closed) return std::nullopt;  // an open surface encloses no volume
  return findings.volume * kCubicMillimetresPerCubicMetre;
}

void print_json(const Inspected& inspected) {
  const mesh_io::LoadedMesh& loaded = inspected.loaded;
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
  json["remarks"] = loaded.findings.remarks;
  json["self_intersections"] = *loaded.findings.crossing_pairs;
  json["organ"] = inspected.refusal.empty();
  json["refused_as_organ"] =
      inspected.refusal.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(inspected.refusal);
  json["refused_as_tool"] = nullptr;
  if (!inspected.tool_refusal.empty()) json["refused_as_tool"] = inspected.tool_refusal;
  if (inspected.support) {
    json["support"] = scene::support_phrases(*inspected.support);
    json["held_share"] = geometry::held_share(*inspected.support, loaded.mesh);
  }
  std::cout << json_text(json) << '\n';
}

std::string padded(std::string label) {
  label.resize(16, ' ');
  return label;
}

void print_list(const char* name, const std::vector<std::string>& texts) {
  std::string label = padded(name);
  if (texts.empty()) std::cout << "  " << label << "none\n";
  for (const std::string& text : texts) {
    std::cout << "  " << label << text << '\n';
    label.assign(label.size(), ' ');
  }
}

constexpr int kDigits = 6;  // of numbers in the table; --json has all

/// Without an exponent, as a liver has more than a million cubic millimetres.
std::string volume_text(double mm3) { return mm3 < 1e6 ? brief(mm3, kDigits) : fmt::format("{:.0f}", mm3); }

void print_table(const InspectOptions& options, const Inspected& inspected) {
  const mesh_io::LoadedMesh& loaded = inspected.loaded;
  const mesh_io::MeshFindings& findings = loaded.findings;
  const geometry::Bounds box = geometry::bounds(loaded.mesh);
  const auto side = [&](int k) {
    return fmt::format("{} .. {} mm", brief(box.low[k] / kMillimetre, kDigits),
                       brief(box.high[k] / kMillimetre, kDigits));
  };
  const auto row = [](const std::string& name, const std::string& value) {
    std::cout << "  " << padded(name) << value << '\n';
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
  row("volume", volume ? volume_text(*volume) + " mm^3" : "none: not closed");
  row("crossing pairs",
      fmt::format("{}{} of triangles", inspected.all_crossings ? "" : "at least ", *findings.crossing_pairs));
  print_list("repaired", findings.repairs);
  std::vector<std::string> left = findings.defects;
  left.insert(left.end(), findings.remarks.begin(), findings.remarks.end());
  print_list("not repaired", left);
  row("as an organ", inspected.refusal.empty() ? "yes" : "no: " + inspected.refusal);
  row("as a tool", inspected.tool_refusal.empty() ? "yes" : "no: " + inspected.tool_refusal);
  if (inspected.support) {
    print_list("held by", scene::support_phrases(*inspected.support));
    row("held",
        fmt::format("{:.1f} % of the surface", 1e2 * geometry::held_share(*inspected.support, loaded.mesh)));
  }
}

}  // namespace

void add_inspect(CLI::App& program, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("inspect", "Describe a mesh, its repairs and the defects that remain");
  auto options = std::make_shared<InspectOptions>();
  command
      ->add_option("mesh", options->mesh,
                   "a file (" + joined(mesh_io::mesh_file_extensions(), " ") +
                       ") or a built-in organ (gallbladder, heart, liver, kidney, each also -30k and -300k; "
                       "ball, box)")
      ->required();
  command->add_option("--unit", options->unit, "unit of the file: mm, cm, m or in (default mm)");
  command->add_option("--organ-support", options->support,
                      "what holds the organ, as for palpate run: says how much of the surface that is");
  command->add_option(
      "--screenshot", options->screenshot,
      "with --organ-support: draws the organ to this PNG file from above and from below, what is "
      "held in colour");
  command->add_flag("--json", options->as_json, "one JSON document");
  command->footer(
      "Examples: palpate inspect liver.stl --unit mm --json\n"
      "          palpate inspect liver-tetrahedra.msh --unit mm\n"
      "          palpate inspect heart --organ-support at:5,64,-7,30 --screenshot held.png");
  command->callback([options, &exit_code] {
    if (!options->screenshot.empty()) {
      if (options->support.empty())
        throw InputError("--screenshot: shows what is held, needs --organ-support");
      check_screenshot(*options);
    }
    const Inspected inspected = inspect(*options);
    if (is_path(options->mesh) && options->unit.empty()) {
      report_message(options->mesh + ": no --unit given: mm is assumed");
    }
    if (options->as_json) {
      print_json(inspected);
    } else {
      print_table(*options, inspected);
    }
    if (!options->screenshot.empty()) {
      if (!inspected.support)
        throw InputError("--screenshot: shows what is held, and --organ-support is none");
      render::write_png(report::draw_held(inspected.loaded.mesh, *inspected.support, kPictureHeight),
                        options->screenshot);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
