// `palpate fit`: identifies tissue parameters from measured force-displacement curves.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/units.h"
#include "run/tasks/communicator.h"

#include "app/commands.h"
#include "app/components.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/progress.h"
#include "app/session.h"
#include "fit/commands/commands.h"
#include "fit/commands/fit_summary.h"
#include "fit/identify/fit_many.h"
#include "fit/identify/map_check.h"
#include "fit/identify/map_choice.h"
#include "fit/identify/map_fit.h"
#include "fit/identify/map_tissue.h"
#include "fit/identify/needle_fit.h"
#include "fit/identify/sweep.h"
#include "fit/report/fit_report.h"
#include "fit/report/needle_report.h"

namespace palpate::app {
namespace {

struct FitFlags {
  std::vector<std::string> files;
  std::string law = "layered";
  std::string direction = "press";
  bool relaxation = false;
  std::string rate = "1000";
  std::string t1 = "1";
  std::string bootstrap = "0";
  std::string seed = "1";
  std::string out;
  std::string report;
  std::vector<std::string> sweeps;
  std::string sweep_csv;
  bool is_map = false;
  std::string radius;
  std::string max_inclusions = "6";
  std::string stiffness_map;
  bool is_needle = false;
  bool as_json = false;
};

identify::Settings settings_of(const FitFlags& flags) {
  constexpr std::uint64_t kMaxResamples = 100'000;
  identify::Settings settings;
  if (flags.law != "layered" && flags.law != "smooth") {
    throw InputError("--law " + flags.law + ": must be layered or smooth");
  }
  settings.law = model::parse_law(flags.law);
  if (flags.direction != "press" && flags.direction != "pull") {
    throw InputError("--direction " + flags.direction + ": must be press or pull");
  }
  settings.direction = flags.direction == "pull" ? model::Direction::kPull : model::Direction::kPress;
  settings.relaxation = flags.relaxation;
  settings.period = 1.0 / parse_positive("--rate-Hz", flags.rate);
  if (settings.period > 1e300) throw InputError("--rate-Hz " + flags.rate + ": must be > 1e-300");
  settings.t1 = parse_positive("--t1-us", flags.t1) * kMicrosecond;
  const std::uint64_t resamples = parse_whole("--bootstrap", flags.bootstrap);
  if (resamples > kMaxResamples) {
    throw InputError(fmt::format("--bootstrap {}: must be at most {}", flags.bootstrap, kMaxResamples));
  }
  settings.bootstrap = static_cast<int>(resamples);
  settings.seed = parse_whole("--seed", flags.seed);
  return settings;
}

/// Reads all specimens of all files. A repeated name gets a number, so that every name is unique.
/// @param timed the fit needs the column time_s @throws InputError
std::vector<identify::Specimen> read_all(const std::vector<std::string>& files, bool timed) {
  std::vector<identify::Specimen> all;
  for (const std::string& file : files) {
    for (identify::Specimen& specimen : identify::read_specimens(to_path(file))) {
      if (timed && specimen.time.empty()) {
        throw InputError(file + ":1: time_s: missing, --relaxation needs the column");
      }
      const std::string name = specimen.name;
      const auto taken = [&all](const std::string& wanted) {
        return std::any_of(all.begin(), all.end(),
                           [&wanted](const identify::Specimen& other) { return other.name == wanted; });
      };
      for (int n = 2; taken(specimen.name); ++n) specimen.name = fmt::format("{} ({})", name, n);
      all.push_back(std::move(specimen));
    }
  }
  return all;
}

void require_writable(const FitFlags& flags) {
  if (!flags.out.empty()) require_writable_file(to_path(flags.out), "--out");
  if (!flags.sweep_csv.empty()) require_writable_file(to_path(flags.sweep_csv), "--sweep-csv");
  if (!flags.report.empty()) require_writable_folder(to_path(flags.report), "--report");
}

/// Reads all specimens on rank 0; the other ranks get an empty list. When rank 0 fails, every rank throws the
/// error of rank 0.
std::vector<identify::Specimen> read_for(tasks::Communicator& ranks, const FitFlags& flags) {
  std::vector<identify::Specimen> specimens;
  tasks::on_rank_zero(ranks, [&] {
    require_writable(flags);  // on rank 0 only: other machines need not have these folders
    specimens = read_all(flags.files, flags.relaxation);
  });
  return specimens;
}

std::vector<identify::ParameterSweep> requests_of(const FitFlags& flags) {
  std::vector<identify::ParameterSweep> requests;
  for (const std::string& text : flags.sweeps) {
    for (const identify::ParameterSweep& request : identify::sweep_requests("--sweep", text))
      requests.push_back(request);
  }
  if (requests.empty() && !flags.sweep_csv.empty()) {
    throw InputError("--sweep-csv " + flags.sweep_csv + ": needs --sweep, which selects the parameters");
  }
  return requests;
}

void write_tissue(const std::string& file, model::TissueParameters tissue) {
  tissue.name = to_text(to_path(file).stem());
  write_output(to_path(file), scene::to_toml(tissue), "--out");
}

void check_fit_outputs(const FitFlags& flags, const std::string& results) {
  std::vector<NamedFile> outputs = {{"--out", to_path(flags.out)},
                                    {"beside --out", to_path(results)},
                                    {"--sweep-csv", to_path(flags.sweep_csv)}};
  if (!flags.report.empty()) outputs.push_back({"--report", to_path(flags.report) / "report.html"});
  std::vector<NamedFile> inputs;
  for (const std::string& file : flags.files) inputs.push_back({"the measurements", to_path(file)});
  require_no_overwrite(outputs, inputs);
}

void fit_all(const FitFlags& flags, const std::string& command_line) {
  const identify::Settings settings = settings_of(flags);
  const std::vector<identify::ParameterSweep> requests = requests_of(flags);
  const std::string results =
      flags.out.empty() || !may_have_files_beside(to_path(flags.out)) ? "" : flags.out + ".fits.jsonl";
  check_fit_outputs(flags, results);
  const std::unique_ptr<tasks::Communicator> ranks = tasks::make_communicator();
  std::vector<identify::Specimen> specimens = read_for(*ranks, flags);
  identify::ManyFits many;
  {
    Progress bar("fit", WithoutTerminal::kLines);
    many = identify::fit_many(specimens, settings, *ranks, results,
                              [&bar](double share, const std::string& what) { bar.update(share, what); });
  }
  identify::Sweeps sweeps;
  if (!requests.empty()) {
    Progress bar("sweep", WithoutTerminal::kLines);
    sweeps = identify::sweep_many(std::move(specimens), many, requests, settings, *ranks, results,
                                  [&bar](double share, const std::string& what) { bar.update(share, what); });
  }
  if (ranks->rank() != 0) return;
  std::error_code ignored;
  const std::string poor = flags.out.empty() ? "" : identify::poor_fit(many.specimens, many.pooled);
  if (!poor.empty()) {
    if (!results.empty()) std::filesystem::remove(to_path(results), ignored);  // it would be read again
    throw InputError("--out " + flags.out + ": not written: " + poor + " (without --out you see the fit)");
  }
  if (many.resumed > 0) {
    report_message(fmt::format("{} of {} specimens were fitted in an earlier run: read from {}", many.resumed,
                               many.specimens.size(), results));
  }
  if (sweeps.resumed > 0) {
    report_message(fmt::format("{} parts of sweeps were finished in an earlier run: read from {}",
                               sweeps.resumed, results));
  }
  if (!flags.sweep_csv.empty()) write_output(to_path(flags.sweep_csv), sweeps_csv(sweeps.all), "--sweep-csv");
  if (!flags.out.empty()) write_tissue(flags.out, many.pooled.tissue);
  if (!flags.report.empty()) {
    const auto page = report::write_fit_report(many.specimens, many.pooled, sweeps.all, settings,
                                               command_line, to_path(flags.report));
    report_message("report: " + to_text(page));
  }
  std::cout << (flags.as_json ? fit_json(many.specimens, many.pooled, sweeps.all)
                              : fit_text(many.specimens, many.pooled) + sweeps_text(sweeps.all));
  if (!results.empty()) std::filesystem::remove(to_path(results), ignored);  // the outputs contain all of it
}

/// Rejects flags that have no effect with, or without, --map or --needle.
void require_flags_of(const FitFlags& flags, const CLI::App& command) {
  const std::vector<std::string> for_map = {"--radius-mm", "--max-inclusions", "--stiffness-map"};
  const std::vector<std::string> for_needles = {"--law", "--rate-Hz", "--t1-us", "--report"};
  const std::vector<std::string> for_curves = {"--direction", "--relaxation", "--bootstrap",
                                               "--seed",      "--sweep",      "--sweep-csv"};
  if (flags.is_map && flags.is_needle) throw InputError("--map and --needle: leave one out");
  const auto reject = [&command](const std::vector<std::string>& names, const std::string& why) {
    for (const std::string& name : names) {
      if (command.count(name) > 0) throw InputError(name + ": " + why);
    }
  };
  const std::string unused =
      std::string("has no effect with ") + (flags.is_map ? "--map" : "--needle") + ": leave it out";
  if (!flags.is_map) reject(for_map, "needs --map");
  if (flags.is_map) reject(for_needles, unused);
  if (flags.is_map || flags.is_needle) reject(for_curves, unused);
}

void fit_needles(const FitFlags& flags, bool law_given, const std::string& command_line) {
  identify::Settings settings = settings_of(flags);
  if (!law_given) settings.law = model::LawKind::kSmooth;
  check_fit_outputs(flags, "");
  require_writable(flags);
  std::vector<identify::Insertion> records;
  for (const std::string& file : flags.files) {
    for (identify::Insertion& one : identify::read_insertions(file)) records.push_back(std::move(one));
  }
  identify::NeedleFit fit;
  {
    Progress bar("fit", WithoutTerminal::kLines);
    fit = identify::fit_needle(records, settings,
                               [&bar](double share, const std::string& what) { bar.update(share, what); });
  }
  if (!flags.out.empty() && !fit.poor.empty()) {
    throw InputError("--out " + flags.out + ": not written: " + fit.poor +
                     " (without --out you see the fit)");
  }
  if (!flags.out.empty()) write_tissue(flags.out, fit.tissue);
  if (!flags.report.empty()) {
    report_message("report: " + report::write_needle_report(fit, command_line, flags.report).string());
  }
  std::cout << (flags.as_json ? needle_json(fit) : needle_text(fit));
}

/// The files of a map beside --out.
struct MapOutputs {
  std::filesystem::path scene;
  std::string tissue;     // empty: --out is missing, or can have no files beside it
  std::string stiffness;  // of --stiffness-map, else beside --out
  bool stiffness_by_flag = false;

  [[nodiscard]] const char* stiffness_flag() const {
    return stiffness_by_flag ? "--stiffness-map" : "beside --out";
  }
  /// Their paths from the scene's folder.
  [[nodiscard]] MapFiles named_in_scene() const {
    if (tissue.empty()) return {};
    const auto from_scene = [this](const std::string& file) {
      return to_text(
          std::filesystem::absolute(to_path(file))
              .lexically_normal()
              .lexically_proximate(std::filesystem::absolute(scene).lexically_normal().parent_path()));
    };
    return {from_scene(tissue), from_scene(stiffness)};
  }
};

/// The outputs of --map, checked. @throws InputError
MapOutputs map_outputs_of(const FitFlags& flags) {
  MapOutputs files;
  files.scene = to_path(flags.out);
  files.stiffness = flags.stiffness_map;
  files.stiffness_by_flag = !flags.stiffness_map.empty();
  if (!flags.out.empty() && may_have_files_beside(files.scene)) {
    const auto beside = [&files](const char* ending) {
      return to_text(files.scene.parent_path() / (to_text(files.scene.stem()) + ending));
    };
    files.tissue = beside("-tissue.toml");
    if (!files.stiffness_by_flag) files.stiffness = beside("-stiffness.csv");
  }
  const std::vector<NamedFile> outputs = {{"--out", files.scene},
                                          {"beside --out", to_path(files.tissue)},
                                          {files.stiffness_flag(), to_path(files.stiffness)}};
  require_no_overwrite(outputs, std::vector<NamedFile>{{"the measurements", to_path(flags.files.front())}});
  if (!flags.out.empty()) require_writable_file(to_path(flags.out), "--out");
  if (!files.tissue.empty()) require_writable_file(to_path(files.tissue), "beside --out");
  if (!files.stiffness.empty()) require_writable_file(to_path(files.stiffness), files.stiffness_flag());
  return files;
}

double deepest_row(const std::vector<identify::MapRow>& rows) {
  double deepest = 0.0;
  for (const identify::MapRow& row : rows) deepest = std::max(deepest, row.depth);
  return deepest;
}

void fit_one_map(const FitFlags& flags) {
  constexpr double kPoorTissue = 0.05;  // of the largest force of the background
  if (flags.files.size() != 1) {
    throw InputError(fmt::format("--map: {} files, must be one", flags.files.size()));
  }
  if (flags.radius.empty())
    throw InputError("--radius-mm: missing, must be the radius of the ball that pressed");
  identify::MapSettings settings;
  settings.tip_radius = parse_positive("--radius-mm", flags.radius) * kMillimetre;
  settings.max_inclusions = parse_whole("--max-inclusions", flags.max_inclusions);
  if (settings.max_inclusions > model::kMaxInclusions) {
    throw InputError(
        fmt::format("--max-inclusions {}: must be at most {}", flags.max_inclusions, model::kMaxInclusions));
  }
  const MapOutputs files = map_outputs_of(flags);
  std::vector<identify::MapRow> rows = identify::read_map(to_path(flags.files.front()));
  identify::DescribedMap map;
  std::optional<identify::MapTissue> tissue;
  try {
    std::vector<std::string> doubts = identify::check_map(rows, settings.tip_radius);
    Progress bar("fit", WithoutTerminal::kLines);
    map = identify::describe_map(rows, settings,
                                 [&bar](double share, const std::string& what) { bar.update(share, what); });
    map.warnings.insert(map.warnings.begin(), doubts.begin(), doubts.end());
    if (!files.tissue.empty()) tissue = identify::tissue_of_map(map.predictor, deepest_row(rows));
  } catch (const InputError& error) {
    throw InputError(flags.files.front() + ": " + error.what());
  }
  if (tissue && tissue->error > kPoorTissue) {
    throw InputError(
        fmt::format("--out {}: not written: no tissue with the smooth law is nearer to the "
                    "background's force over depth than {}, must be at most {}",
                    flags.out, percent(tissue->error, 0), percent(kPoorTissue, 0)));
  }
  if (!flags.out.empty()) {
    write_output(files.scene, map_toml(map, files.named_in_scene()), "--out");
    if (tissue) write_output(to_path(files.tissue), scene::to_toml(tissue->tissue), "beside --out");
  }
  if (!files.stiffness.empty())
    write_output(to_path(files.stiffness), map_csv(map.fit), files.stiffness_flag());
  std::cout << (flags.as_json ? map_json(map) : map_text(map));
}

}  // namespace

void add_fit(CLI::App& program, const std::string& command_line, int& exit_code) {
  auto flags = std::make_shared<FitFlags>();
  CLI::App* command = add_component_command(program, "fit");
  command
      ->add_option(
          "DATA", flags->files,
          "CSV files with the columns displacement_mm and force_N, and optionally time_s, specimen and "
          "indenter_radius_mm")
      ->required();
  command->add_option("--law", flags->law, "layered or smooth (default layered)");
  command->add_option("--direction", flags->direction,
                      "direction of the measurements: press or pull (default press)");
  command->add_flag("--relaxation", flags->relaxation,
                    "also fit relaxation, with one to three terms; needs the column time_s");
  command->add_option("--rate-Hz", flags->rate,
                      "loop rate at which the tissue is used; it limits the number of layers (default 1000)");
  command->add_option("--t1-us", flags->t1, "delay of the first layer, microseconds (default 1)");
  command->add_option("--bootstrap", flags->bootstrap,
                      "number of bootstrap resamples, for a second kind of interval (default 0: none)");
  command->add_option("--seed", flags->seed, "seed of the random numbers for the intervals (default 1)");
  command->add_option("--out", flags->out, "tissue file to write, from the pooled fit of all specimens");
  command->add_option("--report", flags->report, "folder for a report with one figure per specimen");
  command->add_option(
      "--sweep", flags->sweeps,
      "PARAM or PARAM=LOW:HIGH[:N]: fix k1_N_per_m, beta, q or limit_mm (all: each of them) at N values, "
      "fit the other parameters again, and report the values that the data allow (repeat the flag for more "
      "parameters; default: 21 values around the interval)");
  command->add_option("--sweep-csv", flags->sweep_csv, "CSV file for the sweeps, one line per value");
  command->add_flag(
      "--map", flags->is_map,
      "DATA is one map of many probes: columns probe, x_mm, y_mm, z_mm, depth_mm, force_N and "
      "optionally nx, ny, nz; finds the inclusions under the surface, or a map of the stiffness, whichever "
      "predicts held-out probes better (docs/lumps.md)");
  command->add_option("--radius-mm", flags->radius, "with --map, required: radius of the ball that pressed");
  command->add_option("--max-inclusions", flags->max_inclusions, "with --map: at most so many (default 6)");
  command->add_option(
      "--stiffness-map", flags->stiffness_map,
      "with --map: CSV file of the tissue's stiffness at every probe, for [organ.stiffness] (default: "
      "beside --out)");
  command->add_flag(
      "--needle", flags->is_needle,
      "DATA are records of a needle that goes into layers, rests and is drawn out, one or more of the same "
      "kind: time_s, displacement_mm (depth of the tip), force_N (positive against the needle that goes in); "
      "finds "
      "punctures, layers, cutting, friction and relaxation (docs/needle.md); --law is smooth by default");
  add_jobs(*command);
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n"
      "  palpate fit liver-1.csv liver-2.csv --law smooth --out liver.toml --report liver-fit\n"
      "  palpate fit hold.csv --direction press --relaxation --bootstrap 200 --json\n"
      "  palpate fit liver-1.csv liver-2.csv --sweep q=0.5:0.9:41 --sweep-csv q.csv --report liver-fit\n"
      "  mpirun -n 8 palpate fit specimens/*.csv --bootstrap 200 --out liver.toml\n"
      "  palpate fit --map probes.csv --radius-mm 3.16 --out lumps.toml --stiffness-map stiffness.csv\n"
      "  palpate fit --needle insertion-1.csv insertion-2.csv --out skin.toml --report skin-fit\n"
      "With --out the same command continues a fit that was interrupted.\n"
      "docs/fitting.md explains how to measure and how to read the intervals.");
  command->callback([flags, command_line, command, &exit_code] {
    require_flags_of(*flags, *command);
    if (flags->is_map) {
      fit_one_map(*flags);
    } else if (flags->is_needle) {
      fit_needles(*flags, command->count("--law") > 0, command_line);
    } else {
      fit_all(*flags, command_line);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
