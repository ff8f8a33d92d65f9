// `palpate inspect`: describes a mesh and lists its repairs and the defects that cannot be repaired.
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
#include "io/system/path_text.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"
#include "palpate/surface.h"
#include "palpate/units.h"
#include "view/report/subject.h"
#include "view/report/surface_error.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/output.h"
#include "app/session.h"

namespace palpate::app {
namespace {

struct InspectOptions {
  std::string mesh;
  std::string unit;
  std::vector<std::string> support;  // --organ-support
  std::filesystem::path reference;   // --reference
  std::vector<double> press;         // --press: place, direction, depth and the tool's radius
  double error_range = 0.0;          // --error-mm [m]; 0: the largest error
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
  std::optional<report::SurfaceError> error;
  double depth = 0.0;  // of the press that the error belongs to [m]
};

mesh_io::LoadedMesh load(const InspectOptions& options) {
  if (is_path(options.mesh)) {
    const LengthUnit unit = options.unit.empty() ? LengthUnit::kMillimetre : parse_length_unit(options.unit);
    return mesh_io::read_mesh(to_path(options.mesh), unit);
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
  std::vector<NamedFile> inputs;
  if (!options.reference.empty()) inputs.push_back({"--reference", options.reference});
  if (is_path(options.mesh)) inputs.push_back({"the mesh", to_path(options.mesh)});
  if (is_path(options.mesh))
    for (const std::filesystem::path& buffer : mesh_io::gltf_buffer_files(to_path(options.mesh)))
      inputs.push_back({"a buffer of the mesh", buffer});
  require_no_overwrite(std::vector<NamedFile>{{"--screenshot", options.screenshot}}, inputs);
}

std::string without_start(const std::string& text, const std::string& start) {
  return text.starts_with(start) ? text.substr(start.size()) : text;
}

deform::Indentation press_of(const std::vector<double>& n) {
  const Vec3 direction(n[3], n[4], n[5]);
  if (!(direction.norm() > 0.0)) throw InputError("--press: the direction is 0, must not be");
  if (!(n[6] > 0.0)) throw InputError(fmt::format("--press: the depth is {} mm, must be > 0", n[6]));
  if (!(n[7] > 0.0)) throw InputError(fmt::format("--press: the radius is {} mm, must be > 0", n[7]));
  return {Vec3(n[0], n[1], n[2]) * kMillimetre, direction.normalized(), n[6] * kMillimetre,
          n[7] * kMillimetre, 0.0};
}

void compare(const InspectOptions& options, Inspected& inspected) {
  if (!inspected.refusal.empty())
    throw InputError("--reference: " + options.mesh + " cannot be an organ: " + inspected.refusal);
  const deform::Indentation press = press_of(options.press);
  const geometry::TriangleMesh& organ = inspected.loaded.mesh;
  inspected.error = report::surface_error(organ, report::read_reference(options.reference, organ), press,
                                          inspected.support);
  inspected.depth = press.depth;
}

Inspected inspect(const InspectOptions& options) {
  Inspected inspected{load(options), {}, {}, true, {}, {}, 0.0};
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
  if (auto stated = scene::support_by_flags(options.support)) {
    if (!inspected.refusal.empty())
      throw InputError("--organ-support: " + options.mesh + " cannot be an organ: " + inspected.refusal);
    scene::read_painted(*stated,
                        options.unit.empty() ? LengthUnit::kMillimetre : parse_length_unit(options.unit));
    scene::check_support(*stated, inspected.loaded.mesh);
    inspected.support = stated->support;
  }
  if (!options.reference.empty()) compare(options, inspected);
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
    const deform::ResponseCells cells = deform::response_cells(loaded.mesh);
    json["cell_mm"] = cells.edge / kMillimetre;
    json["thin_share"] = cells.thin_share;
  }
  if (inspected.error) {
    json["surface_error"] = {{"rms_mm", inspected.error->rms / kMillimetre},
                             {"max_mm", inspected.error->largest / kMillimetre},
                             {"max_at_mm", in_mm(inspected.error->where)},
                             {"depth_mm", inspected.depth / kMillimetre},
                             {"compared_share", inspected.error->compared}};
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
    row("cells", deform::describe(deform::response_cells(loaded.mesh)));
  }
  if (inspected.error) {
    const report::SurfaceError& error = *inspected.error;
    row("surface error",
        fmt::format("RMS {} mm, {:.1f} % of the depth, over the {:.1f} % of the surface that "
                    "moves by over 2 % of it",
                    brief(error.rms / kMillimetre, 3), 1e2 * error.rms / inspected.depth,
                    1e2 * error.compared));
    row("largest",
        fmt::format("{} mm at ({}, {}, {}) mm", brief(error.largest / kMillimetre, 3),
                    brief(error.where.x() / kMillimetre, 3), brief(error.where.y() / kMillimetre, 3),
                    brief(error.where.z() / kMillimetre, 3)));
  }
}

void draw(const InspectOptions& options, const Inspected& inspected) {
  const geometry::TriangleMesh& organ = inspected.loaded.mesh;
  if (inspected.error) {
    const double range = options.error_range > 0.0 ? options.error_range : inspected.error->largest;
    render::write_png(report::draw_error(organ, *inspected.error, range, kPictureHeight), options.screenshot);
    return;
  }
  if (!inspected.support) throw InputError("--screenshot: shows what is held, and --organ-support is none");
  render::write_png(report::draw_held(organ, *inspected.support, kPictureHeight), options.screenshot);
}

void check_flags(const InspectOptions& options) {
  if (options.reference.empty() != options.press.empty())
    throw InputError(options.press.empty() ? "--reference: needs --press, the press that it belongs to"
                                           : "--press: needs --reference, the displacements under it");
  if (options.error_range > 0.0 && (options.reference.empty() || options.screenshot.empty()))
    throw InputError("--error-mm: ends the colours of the error, needs --reference and --screenshot");
  if (options.screenshot.empty()) return;
  if (options.support.empty() && options.reference.empty())
    throw InputError("--screenshot: shows what is held or an error, needs --organ-support or --reference");
  check_screenshot(options);
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
      "with --organ-support or --reference: draws the organ to this PNG file from above and from below, "
      "what is held or the error in colour");
  command->add_option(
      "--reference", options->reference,
      "displacements of all vertices under --press, by finite elements for example: a CSV file "
      "with x_mm, y_mm, z_mm, u_x_mm, u_y_mm, u_z_mm. Says how far the shown surface is off");
  command
      ->add_option("--press", options->press,
                   "with --reference: X,Y,Z,DX,DY,DZ,DEPTH,RADIUS in mm: a place of the surface, the "
                   "direction and length of its displacement, and the tool's radius")
      ->delimiter(',')
      ->expected(8);
  add_number(*command, "--error-mm", options->error_range, Numbers::kPositive,
             "with --reference and --screenshot: the error at the end of the colours (default: the largest)",
             kMillimetre);
  command->add_flag("--json", options->as_json, "one JSON document");
  command->footer(
      "Examples: palpate inspect liver.stl --unit mm --json\n"
      "          palpate inspect liver-tetrahedra.msh --unit mm\n"
      "          palpate inspect heart --organ-support at:5,64,-7,30 --screenshot held.png");
  command->callback([options, &exit_code] {
    check_flags(*options);
    const Inspected inspected = inspect(*options);
    if (is_path(options->mesh) && options->unit.empty()) {
      report_message(options->mesh + ": no --unit given: mm is assumed");
    }
    if (options->as_json) {
      print_json(inspected);
    } else {
      print_table(*options, inspected);
    }
    if (!options->screenshot.empty()) draw(*options, inspected);
    exit_code = kDone;
  });
}

}  // namespace palpate::app
