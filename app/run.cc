// `palpate run`: one interaction, in real time or offline.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "palpate/base/error.h"
#include "palpate/report/report.h"

#include "app/commands.h"
#include "app/preparation.h"
#include "app/progress.h"
#include "app/session.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct RunFlags {
  scene::Request request;
  bool offline = false;
  bool headless = false;  // there is no window yet: runs are headless either way
  bool json = false;
  bool no_cache = false;
  std::optional<double> duration_s;
  std::optional<std::uint64_t> max_missed;
  std::optional<int> igtl_port;
  std::optional<int> core;
  OutputFiles files;
};

/// A recording that is only needed to draw a picture from; gone at the end.
class TemporaryFile final {
 public:
  TemporaryFile() : path_(fs::temp_directory_path() / ("palpate-" + std::to_string(getpid()) + ".h5")) {}
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const fs::path& path() const noexcept { return path_; }

 private:
  fs::path path_;
};

void check_outputs(const OutputFiles& files) {
  if (!files.recording.empty()) require_writable_file(files.recording, "--record");
  if (!files.screenshot.empty()) require_writable_file(files.screenshot, "--screenshot");
  if (!files.report.empty()) require_writable_folder(files.report, "--report");
}

int run(const RunFlags& flags, const std::string& command_line) {
  if (flags.igtl_port) {
    throw InputError("--igtl " + std::to_string(*flags.igtl_port) +
                     ": OpenIGTLink is not in this version of palpate; run without --igtl");
  }
  require_usable_core(flags.core);
  Session session = prepare(flags.request, flags.duration_s, flags.no_cache);
  OutputFiles files = flags.files;
  check_outputs(files);

  std::optional<TemporaryFile> temporary;
  if (!files.report.empty()) {
    fs::create_directories(files.report);
    if (files.recording.empty()) files.recording = files.report / "recording.h5";
  }
  fs::path recorded = files.recording;
  if (recorded.empty() && !files.screenshot.empty()) recorded = temporary.emplace().path();

  const std::string title = title_of(session.setup);
  RunAccount account;
  {
    const StopOnSignal signals;
    account = play(session, {recorded, flags.offline, flags.core}, signals.flag());
  }
  const bool draw = account.loop.ticks > 0 && !(files.report.empty() && files.screenshot.empty());
  if (draw) {
    const record::Recording recording = record::read_recording(recorded);
    if (!files.screenshot.empty())
      write_screenshot(recording, account.highlights, files.screenshot, flags.no_cache);
    if (!files.report.empty()) {
      Progress bar("report");
      files.report =
          report::write_report({{title, &recording, command_line}}, files.report,
                               [&bar](double done, const std::string& what) { bar.update(done, what); });
    }
  }
  if (flags.json) {
    std::cout << summary_json(account, files).dump(2) << '\n';
  } else {
    print_summary(std::cout, account, files);
  }
  return exit_code_of(account, flags.max_missed);
}

void add_scene_flags(CLI::App& command, RunFlags& flags) {
  scene::Request& request = flags.request;
  command.add_option("SCENE", request.scene, "scene file (.toml); none: the gallbladder press");
  command.add_option("--task", request.task, "press or pull");
  command.add_option("--organ", request.organ, "built-in organ or mesh file");
  command.add_option("--organ-unit", request.organ_unit, "unit of the organ's file: mm, cm, m or in");
  command
      .add_option("--organ-motion", request.organ_motion,
                  "breathing, heartbeat or none; again for each, in place of the scene's")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--tissue", request.tissue, "built-in tissue or tissue file");
  command.add_option("--tool", request.tools, "built-in tool or mesh file; again for each jaw")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--tool-unit", request.tool_unit, "unit of the tool's files");
  command.add_option("--device", request.device,
                     "KIND[:PATH]: scripted, scripted:path.csv, emulated, replay:rec.h5, "
                     "forcedimension, haply (`palpate devices` says what is there)");
  command.add_option("--rate-Hz", request.rate_Hz, "haptic ticks a second");
  command.add_option("--seed", request.seed, "of the touch noise");
  command.add_flag("--no-noise", request.no_noise, "leave the touch noise out");
}

void add_run_flags(CLI::App& command, RunFlags& flags) {
  command.add_flag("--offline", flags.offline, "as fast as possible, the same rows");
  command.add_option("--duration-s", flags.duration_s, "exactly round(S x rate) ticks");
  command.add_option("--record", flags.files.recording, "write every tick to this HDF5 file");
  command.add_option("--report", flags.files.report, "write report.html and its figures to this folder");
  command.add_option("--screenshot", flags.files.screenshot, "write a PNG of the deepest moment");
  command.add_flag("--headless", flags.headless, "no window");
  command.add_option("--max-missed", flags.max_missed, "exit 4 when more deadlines were missed");
  command.add_option("--core", flags.core, kCoreHelp);
  command.add_option("--igtl", flags.igtl_port, "OpenIGTLink port (not in this version)");
  command.add_flag("--no-cache", flags.no_cache, kNoCacheHelp);
  command.add_flag("--json", flags.json, "summary as one JSON document");
}

}  // namespace

void add_run(CLI::App& program, const std::string& command_line, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("run", "One interaction: an organ is touched, felt, seen, recorded");
  auto flags = std::make_shared<RunFlags>();
  add_scene_flags(*command, *flags);
  add_run_flags(*command, *flags);
  command->footer(
      "Example: palpate run --organ liver.stl --organ-unit mm --tissue liver --tool sphere:3 \\\n"
      "           --record liver.h5 --report out\n"
      "A fault brings the force to zero and keeps it there; kill -USR1 PID resets the faults of all hands.\n"
      "Exit: 0 done, 2 bad input, 3 a fault was latched (also when it was reset),\n"
      "      4 more than --max-missed deadlines missed");
  command->callback([flags, &command_line, &exit_code] { exit_code = run(*flags, command_line); });
}

}  // namespace palpate::app
