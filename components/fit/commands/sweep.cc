// `palpate sweep`: runs a scene over a grid of parameter values.
#include "fit/sweep/sweep.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/scene_keys.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/organ_cache.h"

#include "app/commands.h"
#include "app/components.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/scene_flags.h"
#include "app/session.h"
#include "fit/commands/commands.h"
#include "fit/report/sweep_figure.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;
using session::kRunQuantities;

struct SweepFlags {
  sweep::SweepRequest request;
  std::vector<std::string> settings;
  std::string out;
  bool no_cache = false;
  bool as_json = false;
};

/// File names of a sweep's outputs, in the folder of --out.
constexpr std::array kFiles = {"results.csv", "results.h5", "results.svg", "results.jsonl"};

/// Flags, and the prefix of the scene keys that each flag overrides.
constexpr std::pair<const char*, const char*> kOverrides[] = {{"--task", "scene.task"},
                                                              {"--organ", "organ.mesh"},
                                                              {"--organ", "organ.unit"},
                                                              {"--organ-unit", "organ.unit"},
                                                              {"--organ-motion", "organ.motion."},
                                                              {"--tissue", "organ.tissue"},
                                                              {"--tool", "tool."},
                                                              {"--tool-unit", "tool.unit"},
                                                              {"--device", "device.kind"},
                                                              {"--device", "device.path"},
                                                              {"--rate-Hz", "scene.rate_Hz"},
                                                              {"--seed", "scene.seed"},
                                                              {"--no-noise", "noise."},
                                                              {"--fit-device", "device.fit"}};

/// @throws InputError for a swept key that a flag would override in every run
void refuse_overridden(const std::vector<sweep::Axis>& axes, const CLI::App& command) {
  for (const sweep::Axis& axis : axes) {
    for (const auto& [flag, key] : kOverrides) {
      if (!axis.key.starts_with(key) || command.count(flag) == 0) continue;
      throw InputError(fmt::format("--set {}: {} sets it in every run; omit one of them", axis.key, flag));
    }
  }
}

void check_files_and_duration(const SweepFlags& flags) {
  const sweep::SweepRequest& request = flags.request;
  require_writable_folder(to_path(flags.out), "--out");
  const scene::Scene scene = scene::load(request.scene);
  if (request.duration_s) (void)session::ticks_in(*request.duration_s, scene.rate_Hz, "--duration-s");
  std::vector<NamedFile> outputs;
  for (const char* name : kFiles) outputs.push_back({"--out", to_path(flags.out) / name});
  std::vector<NamedFile> inputs = sources_of(scene);
  for (const sweep::Axis& axis : request.axes) {
    for (const std::string& value : axis.values) {
      for (const fs::path& file : sweep::files_of(request, axis, value))
        inputs.push_back({"--set " + axis.key, file});
    }
  }
  require_no_overwrite(outputs, inputs);
}

/// Minimum and maximum of a quantity over the runs that did not fail.
std::pair<double, double> span_of(const sweep::SweepResult& sweep, std::size_t quantity) {
  std::vector<double> values;
  for (const sweep::SweepRow& row : sweep.rows) {
    if (!row.failed()) values.push_back(row.quantities[quantity]);
  }
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {*least, *most};
}

std::string sweep_text(const sweep::SweepResult& sweep, const std::string& out) {
  std::string text = fmt::format("{}: {}", sweep.scene, counted(sweep.rows.size(), "run", "runs"));
  for (const sweep::Axis& axis : sweep.axes) {
    text +=
        fmt::format("{} {} ({} to {}, {})", &axis == sweep.axes.data() ? " over" : " and", axis.key,
                    axis.values.front(), axis.values.back(), counted(axis.values.size(), "value", "values"));
  }
  text += '\n';
  for (std::size_t i = 0; sweep.failed() < sweep.rows.size() && i < kRunQuantities.size(); ++i) {
    const auto [least, most] = span_of(sweep, i);
    text += fmt::format("  {:<34} {} to {}\n", kRunQuantities[i].label, brief(least), brief(most));
  }
  return text + "Table: " + to_text(to_path(out) / kFiles[0]) + " and " + kFiles[1] + '\n';
}

nlohmann::ordered_json json_of(const sweep::Column& column, const std::string& text) {
  if (text.empty()) return nullptr;
  switch (column.type) {
    case scene::KeyType::kNumber:
      return palpate::parse_number(text).value();
    case scene::KeyType::kWhole:
      return std::stoull(text);
    case scene::KeyType::kTruth:
      return sweep::is_true(text);
    case scene::KeyType::kText:
      break;
  }
  return text;
}

nlohmann::ordered_json sweep_json(const sweep::SweepResult& sweep, const std::string& out) {
  using Json = nlohmann::ordered_json;
  Json rows(sweep.rows.size(), Json::object());
  for (const sweep::Column& column : sweep::columns_of(sweep)) {
    for (std::size_t run = 0; run < rows.size(); ++run)
      rows[run][column.name] = json_of(column, column.texts[run]);
  }
  return {{"scene", sweep.scene},     {"out", out},
          {"resumed", sweep.resumed}, {"runs", sweep.rows.size()},
          {"failed", sweep.failed()}, {"missed_contact", sweep.missed()},
          {"results", rows}};
}

/// Reports resumed runs, failed runs, faults and runs without contact on standard error.
void report_findings(const sweep::SweepResult& sweep, const std::string& record) {
  if (sweep.resumed > 0) {
    report_message(fmt::format("{} of {} runs were finished in an earlier sweep: read from {}", sweep.resumed,
                               sweep.rows.size(), record));
  }
  const auto report_first = [&sweep](std::size_t count, const char* what, auto which) {
    if (count == 0) return;
    const auto first = std::find_if(sweep.rows.begin(), sweep.rows.end(), which);
    std::string values;
    for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
      values += (i == 0 ? "" : ", ") + sweep.axes[i].key + " = " + first->settings[i];
    }
    const std::string why = first->failed() ? first->ended.substr(first->ended.find(':')) : "";
    report_message(fmt::format("{} of {} {}, the first with {}{}", count,
                               counted(sweep.rows.size(), "run", "runs"), what, values, why));
  };
  report_first(sweep.failed(), "failed", [](const sweep::SweepRow& row) { return row.failed(); });
  report_first(sweep.with_fault(), "latched a fault",
               [](const sweep::SweepRow& row) { return row.faults > 0; });
  report_first(sweep.missed(), "never touched the organ (missed_contact)",
               [](const sweep::SweepRow& row) { return row.missed_contact; });
}

int sweep(SweepFlags& flags, const CLI::App& command) {
  sweep::SweepRequest& request = flags.request;
  if (!request.scene.scene) throw InputError("SCENE: missing, must be a scene file (.toml)");
  for (const std::string& text : flags.settings) {
    request.axes.push_back(sweep::parse_axis("--set", text));
    const std::string& key = request.axes.back().key;
    const auto same = [&key](const sweep::Axis& axis) { return axis.key == key; };
    if (std::count_if(request.axes.begin(), request.axes.end(), same) > 1) {
      throw InputError("--set " + text + ": " + key + " is set twice");
    }
  }
  refuse_overridden(request.axes, command);
  const fs::path folder = to_path(flags.out);
  request.record = folder / kFiles[3];
  if (!flags.no_cache) scene::use_organ_cache(request.preparation);
  const std::unique_ptr<tasks::Communicator> ranks = tasks::make_communicator();
  tasks::on_rank_zero(*ranks, [&flags] { check_files_and_duration(flags); });
  sweep::SweepResult result;
  {
    Progress bar("sweep", WithoutTerminal::kLines);
    result = sweep::run_sweep(request, *ranks,
                              [&bar](double share, const std::string& what) { bar.update(share, what); });
  }
  if (ranks->rank() == 0) {
    if (!result.record_failure.empty()) report_error(result.record_failure);
    write_output(folder / kFiles[0], sweep::sweep_csv(result), "--out");
    sweep::write_sweep_hdf5(result, folder / kFiles[1]);
    const std::string missing = report::draw_sweep(result, folder / kFiles[2]);
    if (!missing.empty()) report_message(std::string(kFiles[2]) + " was not written: " + missing);
    report_findings(result, to_text(request.record));
    std::cout << (flags.as_json ? json_text(sweep_json(result, flags.out)) + '\n'
                                : sweep_text(result, flags.out));
  }
  if (result.failed() > 0 || !result.record_failure.empty()) return kBadInput;
  return result.with_fault() > 0 ? kFault : kDone;
}

}  // namespace

void add_sweep(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<SweepFlags>();
  CLI::App* command = add_component_command(program, "sweep");
  add_scene_flags(*command, flags->request.scene);
  command
      ->add_option("--set", flags->settings,
                   "KEY=LOW:HIGH:N (N evenly spaced values; with :log after it, logarithmic spacing) or "
                   "KEY=VALUE,VALUE,...; KEY is a key of the scene (path.speed, device.mass_kg) or of its "
                   "tissue (tissue.k1); repeat the flag for more keys: all combinations are run")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--out", flags->out, "folder for results.csv, .h5, .svg and .jsonl")->required();
  command->add_option("--duration-s", flags->request.duration_s,
                      "simulated time of each run: exactly round(S x rate) ticks");
  command->add_flag("--no-cache", flags->no_cache, "prepare organs again and do not cache them");
  add_jobs(*command);
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n"
      "  palpate sweep press.toml --set tissue.k1=10:40:7 --out stiffness\n"
      "  palpate sweep press.toml --set tissue.k1=5:500:9:log --set path.speed=0.5,1,2 --out both --json\n"
      "  mpirun -n 8 palpate sweep press.toml --set organ.tissue=liver,heart --set scene.seed=1:20:20 --out "
      "noise\n"
      "Runs are offline and give the same table on any number of processes. The same command continues\n"
      "an interrupted sweep and repeats the runs that failed. docs/sweeps.md lists the columns.\n"
      "Exit: 0 done, 2 bad input, a run failed (its row states the reason) or the record is incomplete,\n"
      "      3 a run latched a fault");
  command->callback([flags, command, &exit_code] { exit_code = sweep(*flags, *command); });
}

}  // namespace palpate::app
