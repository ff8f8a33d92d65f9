// `palpate validate`: compares the model with measurements.
#include "palpate/validate.h"

#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/components.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/scene_flags.h"
#include "app/session.h"
#include "fit/commands/commands.h"
#include "fit/commands/fit_summary.h"
#include "fit/imaging/compare.h"
#include "fit/report/validation_report.h"
#include "fit/validate/baselines.h"

namespace palpate::app {
namespace {

struct ValidateFlags {
  std::vector<std::string> files;     // force-displacement curves
  std::vector<std::string> profiles;  // surface displacement u(r)
  LawFlags law;
  bool zeros_fitted = false;
  std::optional<double> first_contact;  // displacement at first contact [m]
  std::optional<double> offset;         // force reading without load [N]
  std::string depth;
  std::string force;
  std::optional<double> tip_radius;  // m
  std::optional<double> max_nrmse;
  std::optional<double> max_error_N;
  std::optional<double> max_error_mm;
  ImageFlags image;
  std::string against;
  bool fit_reach = false;
  validate::SurfaceRule rule;
  std::string out;
  std::string report;
  bool is_map = false;
  std::string scene;  // that palpate fit --map wrote
  bool as_json = false;
};

constexpr imaging::RequestNames kFlagNames = {
    "--depth-mm",
    "--force-N",
    "--tip-radius-mm",
    "nothing to compare with: give force curves (DATA), --profile FILE or --image BEFORE AFTER",
    "--zeros fitted: applies to force curves, needs DATA",
    "--zeros fitted: fits the zeros that --first-contact-mm and --offset-N give; use one or the other",
    "--as-drawn: applies to a ball that is pressed in, needs --direction press",
    "--depth-mm, --force-N and --tip-radius-mm: apply to profiles, need --profile FILE or --image BEFORE "
    "AFTER"};

/// Values of a list flag in SI, each > 0; absent without the flag. @throws InputError
std::optional<std::vector<double>> positive_list(const char* name, const std::string& text, double unit) {
  if (text.empty()) return std::nullopt;
  std::vector<double> values = parse_not_negative_list(name, text);
  for (double& value : values) {
    if (!(value > 0.0)) throw InputError(fmt::format("{} {}: must be > 0", name, shortest(value)));
    value *= unit;
  }
  return values;
}

std::vector<identify::Specimen> read_forces(const ValidateFlags& flags) {
  std::vector<identify::Specimen> all;
  for (const std::string& file : flags.files) {
    for (identify::Specimen& specimen : identify::read_specimens(to_path(file)))
      all.push_back(std::move(specimen));
  }
  return all;
}

std::vector<validate::Deformation> read_profiles(const ValidateFlags& flags) {
  std::vector<validate::Deformation> all;
  for (const std::string& file : flags.profiles) {
    for (validate::Deformation& profile : validate::read_deformations(to_path(file)))
      all.push_back(std::move(profile));
  }
  return all;
}

/// Adds a line to `missed` when the error of the data set `name` exceeds the goal of `flag`.
void hold(const std::string& flag, std::optional<double> goal, double error, const std::string& name,
          std::vector<std::string>& missed) {
  if (!goal || error <= *goal) return;
  missed.push_back(fmt::format("{}: {}, {} is {}", name, shortest(error), flag, shortest(*goal)));
}

void hold_goals(const ValidateFlags& flags, report::Validation& validation) {
  for (const report::ForceSet& set : validation.forces) {
    const std::string& name = set.ours.measured.name;
    hold("--max-nrmse", flags.max_nrmse, set.ours.errors.nrmse, name, validation.missed);
    hold("--max-error-N", flags.max_error_N, set.ours.errors.max, name, validation.missed);
  }
  for (const report::ProfileSet& set : validation.profiles) {
    const std::string& name = set.ours.measured.name;
    hold("--max-nrmse", flags.max_nrmse, set.ours.errors.nrmse, name, validation.missed);
    hold("--max-error-mm", flags.max_error_mm, set.ours.errors.max / kMillimetre, name, validation.missed);
  }
}

/// Rejects a goal for a depth that was chosen so that the model agrees. @throws InputError
void require_measured_depth(const ValidateFlags& flags, const report::Validation& validation) {
  if (!validation.image || !validation.image->depth_fitted) return;
  for (const auto& [flag, goal] :
       {std::pair{"--max-nrmse", flags.max_nrmse}, std::pair{"--max-error-mm", flags.max_error_mm}}) {
    if (!goal) continue;
    throw InputError(
        fmt::format("{}: {}: the tool hides the deepest place, so the depth is fitted to the line and no "
                    "goal can be judged: give the measured --depth-mm (or --force-N), or leave out the goal",
                    validation.image->comparison.measured.name, flag));
  }
}

/// What the flags ask for, with the data read from their files. @throws InputError
imaging::Request request_of(const ValidateFlags& flags) {
  if (!flags.out.empty() && !flags.fit_reach) throw InputError("--out: needs --fit-reach");
  imaging::Request request;
  request.law = {flags.law.load(), flags.law.direction, 1.0 / flags.law.rate_Hz};
  request.photographs = photographs_of(flags.image);
  request.zeros_fitted = flags.zeros_fitted;
  request.first_contact = flags.first_contact;
  request.offset = flags.offset;
  request.depths = positive_list(kFlagNames.depths, flags.depth, kMillimetre);
  request.loads = positive_list(kFlagNames.loads, flags.force, 1.0);
  request.tip_radius = flags.tip_radius;
  request.fit_reach = flags.fit_reach;
  request.rule = flags.rule;
  request.baselines = validate::parse_baselines(flags.against);
  request.forces = read_forces(flags);
  request.profiles = read_profiles(flags);
  return request;
}

void check_validate_outputs(const ValidateFlags& flags) {
  std::vector<NamedFile> outputs = {{"--out", to_path(flags.out)}};
  if (!flags.report.empty()) outputs.push_back({"--report", to_path(flags.report) / "report.html"});
  std::vector<NamedFile> inputs = {{"--tissue", to_path(flags.law.tissue)}};
  for (const std::string& file : flags.files) inputs.push_back({"the measurements", to_path(file)});
  for (const std::string& file : flags.profiles) inputs.push_back({"--profile", to_path(file)});
  for (const std::string& file : flags.image.files) inputs.push_back({"--image", to_path(file)});
  require_no_overwrite(outputs, inputs);
  if (!flags.out.empty()) require_writable_file(to_path(flags.out), "--out");
  if (!flags.report.empty()) require_writable_folder(to_path(flags.report), "--report");
}

/// Writes the tissue file of --out with the fitted falloff ratios.
void write_compared_tissue(const std::string& file, const model::TissueParameters& tissue) {
  write_output(to_path(file), scene::to_toml(tissue), "--out");
}

void add_goals(CLI::App& command, ValidateFlags& flags) {
  add_number(command, "--max-nrmse", flags.max_nrmse, Numbers::kNotNegative,
             "goal: RMS error divided by the force range or the depth (0.05 is 5 %); no goal for a profile "
             "whose depth is fitted");
  add_number(command, "--max-error-N", flags.max_error_N, Numbers::kNotNegative,
             "goal: largest error of a force, newtons");
  add_number(command, "--max-error-mm", flags.max_error_mm, Numbers::kNotNegative,
             "goal: largest error of a profile, millimetres");
}

void add_zeros(CLI::App& command, ValidateFlags& flags, CLI::Option* data) {
  using Zeros = std::vector<std::pair<std::string, bool>>;
  add_choice(command, "--zeros", flags.zeros_fitted, Zeros{{"given", false}, {"fitted", true}},
             "given: use the stated first contact and zero of the sensor (default); fitted: fit both. "
             "Both errors are reported; this selects which one is judged and drawn");
  add_number(command, "--first-contact-mm", flags.first_contact, Numbers::kAny,
             "displacement at which the tool touched (default 0)", kMillimetre)
      ->needs(data);
  add_number(command, "--offset-N", flags.offset, Numbers::kAny,
             "reading of the sensor without load (default 0)")
      ->needs(data);
}

void add_profile_flags(CLI::App& command, ValidateFlags& flags) {
  CLI::Option* profile = command.add_option(
      "--profile", flags.profiles,
      "CSV files with the columns r_mm and u_mm, and optionally depth_mm: displacement u of the surface "
      "at a distance r from the contact");
  CLI::Option* depth = command.add_option(
      "--depth-mm", flags.depth,
      "depth of the tool in the profiles: one value, or one per profile, separated by commas");
  command
      .add_option("--force-N", flags.force,
                  "instead of --depth-mm: the load, from which the law gives the depth")
      ->excludes(depth);
  add_number(command, "--tip-radius-mm", flags.tip_radius, Numbers::kPositive,
             "radius of the tool's tip in the profiles (default: from [tissue.source])", kMillimetre);
  command
      .add_flag("--fit-reach", flags.fit_reach,
                "first fit the tissue's displacement profile ([tissue.reach]) to all profiles together")
      ->needs(profile);
  CLI::Option* drawn = command
                           .add_flag("--as-drawn", flags.rule.as_drawn,
                                     "compare (and fit) the surface as it is drawn, which is never above the "
                                     "ball's surface, instead of u(r) alone")
                           ->needs(profile);
  add_number(command, "--surface-radius-mm", flags.rule.rest_radius, Numbers::kPositive,
             "with --as-drawn: radius of a surface at rest that bulges towards the ball (default: flat)",
             kMillimetre)
      ->needs(drawn);
  command.add_option("--out", flags.out,
                     "with --fit-reach: tissue file to write, with the fitted displacement profile");
}

/// Rejects flags that have no effect with, or without, --map.
void require_map_flags(const ValidateFlags& flags, const CLI::App& command) {
  if (!flags.is_map) {
    if (!flags.scene.empty()) throw InputError("--scene " + flags.scene + ": needs --map");
    if (flags.law.tissue.empty()) throw CLI::RequiredError("--tissue");
    return;
  }
  const std::set<std::string> used = {"DATA", "--map", "--scene", "--max-nrmse", "--max-error-N", "--json"};
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || used.count(option->get_name()) > 0) continue;
    throw InputError(option->get_name() + ": has no effect with --map: leave it out");
  }
  if (flags.files.size() != 1) {
    throw InputError(fmt::format("--map: {} files, must be one", flags.files.size()));
  }
  if (flags.scene.empty()) {
    throw InputError("--scene: missing, must be the scene that palpate fit --map wrote with --out");
  }
}

/// Predicts the probes of a map. @return the exit code
int validate_one_map(const ValidateFlags& flags) {
  const MapValidation map = validate_map(flags.files.front(), flags.scene);
  std::vector<std::string> missed;
  hold("--max-nrmse", flags.max_nrmse, map.rms / map.range, flags.files.front(), missed);
  hold("--max-error-N", flags.max_error_N, map.largest, flags.files.front(), missed);
  std::cout << (flags.as_json ? map_validation_json(map, missed) : map_validation_text(map, missed));
  return missed.empty() ? kDone : kGoalMissed;
}

}  // namespace

void add_validate(CLI::App& program, const std::string& command_line, int& exit_code) {
  auto flags = std::make_shared<ValidateFlags>();
  CLI::App* command = add_component_command(program, "validate");
  CLI::Option* data = command->add_option(
      "DATA", flags->files,
      "CSV files with the columns displacement_mm and force_N, and optionally time_s, specimen and "
      "indenter_radius_mm");
  add_law_flags(*command, flags->law);
  command->get_option("--tissue")->required(false);  // --map reads that of its scene
  command->add_flag("--map", flags->is_map,
                    "DATA is one map of new probes, as of palpate fit --map; predict them from --scene");
  command->add_option("--scene", flags->scene,
                      "with --map, required: the scene that palpate fit --map wrote");
  add_zeros(*command, *flags, data);
  add_profile_flags(*command, *flags);
  add_image_flags(*command, flags->image);
  add_goals(*command, *flags);
  command->add_option("--against", flags->against,
                      "baseline models, fitted to the same data: hertz,linear,exponential,mass-spring");
  command->add_option("--report", flags->report, "folder for a report with one figure per data set");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Exit code 4 when a goal is missed. Examples:\n"
      "  palpate validate liver-3.csv --tissue liver.toml --max-nrmse 0.05\n"
      "  palpate validate --profile side.csv --tissue liver.toml --depth-mm 5 --tip-radius-mm 5\n"
      "  palpate validate liver-3.csv --tissue liver.toml --against hertz,linear,exponential,mass-spring\n"
      "  palpate validate --profile side.csv --tissue liver.toml --depth-mm 5 --tip-radius-mm 5 --fit-reach "
      "\\\n"
      "    --out liver-reach.toml --report liver-reach\n"
      "  palpate validate --image before.png after.png --scale-mm-per-px 0.08 --tissue liver.toml \\\n"
      "    --tip-radius-mm 3 --report side\n"
      "  palpate validate --map new-probes.csv --scene lumps.toml --max-nrmse 0.08\n"
      "docs/validation.md explains the comparison and its figures.");
  command->callback([flags, command_line, command, &exit_code] {
    require_map_flags(*flags, *command);
    if (flags->is_map) {
      exit_code = validate_one_map(*flags);
      return;
    }
    check_validate_outputs(*flags);
    report::Validation validation = imaging::compare(request_of(*flags), kFlagNames);
    require_measured_depth(*flags, validation);
    hold_goals(*flags, validation);
    if (!flags->out.empty()) write_compared_tissue(flags->out, validation.law.tissue);
    if (!flags->report.empty()) {
      report_message("report: " + to_text(report::write_validation_report(validation, command_line,
                                                                          to_path(flags->report))));
    }
    std::cout << (flags->as_json ? validation_json(validation) : validation_text(validation));
    exit_code = validation.missed.empty() ? kDone : kGoalMissed;
  });
}

}  // namespace palpate::app
