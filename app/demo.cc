// `palpate demo`: runs the paper's two experiments [Zhang 2011] one after the other in real time, then writes
// the report.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/system/path_text.h"
#include "run/session/usable_core.h"
#include "view/report/page.h"
#include "view/report/report.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "app/session.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr double kGoalDepth = 10e-3;  // m, of both experiments

struct Experiment {
  const char* task;
  const char* file;
};
constexpr std::array<Experiment, 2> kExperiments{{{"press", "gallbladder.h5"}, {"pull", "heart.h5"}}};

struct DemoFlags {
  fs::path folder = "out";
  bool json = false;
  bool no_cache = false;
  haptics::LoopThread thread;
  std::array<fs::path, kExperiments.size()> profiles;  // measured; empty: none
};

using Profiles = std::array<std::optional<report::ReferenceProfile>, kExperiments.size()>;

fs::path write_demo_report(const std::vector<std::unique_ptr<Session>>& sessions,
                           const std::vector<OutputFiles>& files, const fs::path& folder,
                           const Profiles& profiles, const std::string& command_line) {
  std::vector<record::Recording> recordings;
  for (const OutputFiles& file : files) recordings.push_back(record::read_recording(file.recording));
  std::vector<report::Experiment> experiments;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    experiments.push_back(
        {title_of(sessions[i]->scene()), &recordings[i], command_line, kGoalDepth, profiles[i]});
  }
  Progress bar("report", WithoutTerminal::kSteps);
  return report::write_report(experiments, folder,
                              [&bar](double done, const std::string& what) { bar.update(done, what); });
}

void check_profiles(const DemoFlags& flags) {
  std::vector<NamedFile> recordings;
  std::vector<NamedFile> profiles;
  for (std::size_t i = 0; i < kExperiments.size(); ++i) {
    recordings.push_back({"--report", flags.folder / kExperiments[i].file});
    profiles.push_back({std::string("--") + kExperiments[i].task + "-profile", flags.profiles[i]});
  }
  require_none_of_report(flags.folder, profiles);
  require_no_overwrite(recordings, profiles);
}

int demo(const DemoFlags& flags, const std::string& command_line) {
  std::optional<StopOnSignal> signals(std::in_place);
  session::require_usable_core(flags.thread.core, "--core");
  require_writable_folder(flags.folder, "--report");
  check_profiles(flags);
  Profiles profiles;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    if (flags.profiles[i].empty()) {
      profiles[i] = report::computed_profile(*scene::find_task(kExperiments[i].task));
    } else {
      profiles[i] = report::read_measured_profile(flags.profiles[i]);
    }
  }
  report::make_report_folder(flags.folder);
  std::vector<std::unique_ptr<Session>> sessions;
  for (const Experiment& experiment : kExperiments) {
    scene::Overrides request;
    request.task = experiment.task;
    sessions.push_back(prepare(scene::load(request), std::nullopt, flags.no_cache, &signals->flag()));
  }

  int exit_code = kDone;
  bool stopped = false;
  nlohmann::ordered_json summaries = nlohmann::ordered_json::array();
  std::vector<OutputFiles> files;
  for (std::size_t i = 0; i < sessions.size() && !stopped; ++i) {
    files.push_back({flags.folder / kExperiments[i].file, {}, {}});
    RunResult result;
    {
      const BackgroundOutput output;
      PlayOptions how;
      how.run = {files[i].recording, false, flags.thread};
      how.stop = &signals->flag();
      result = play(*sessions[i], how);
    }
    stopped = result.loop.stopped_early || !result.recording_failure.empty();
    exit_code = std::max(exit_code, exit_code_of(result, std::nullopt));
    summaries.push_back(summary_json(result, files[i]));
    if (!flags.json) print_summary(std::cout, result, files[i]);
  }
  signals.reset();
  if (stopped) {
    if (flags.json) std::cout << json_text({{"experiments", summaries}, {"report", nullptr}}) << '\n';
    report_message("the demo did not finish; no report was written");
    return exit_code;
  }
  if (!has_pictures()) {
    if (flags.json) std::cout << json_text({{"experiments", summaries}, {"report", nullptr}}) << '\n';
    report_message(
        "no report was written: this program has no pictures; palpate on Linux draws them from the "
        "recordings");
    return exit_code;
  }
  const fs::path page = write_demo_report(sessions, files, flags.folder, profiles, command_line);
  if (flags.json) {
    std::cout << json_text({{"experiments", summaries}, {"report", to_text(page)}}) << '\n';
  } else {
    std::cout << "Report: " << to_text(page) << '\n';
  }
  return exit_code;
}

}  // namespace

void add_demo(CLI::App& program, const std::string& command_line, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "demo", "Run the paper's two experiments with the built-in organs and write the report");
  auto flags = std::make_shared<DemoFlags>();
  command->add_option("--report", flags->folder, "folder for the report and the recordings")
      ->capture_default_str();
  add_thread_flags(*command, flags->thread);
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  for (std::size_t i = 0; i < kExperiments.size(); ++i) {
    command->add_option(std::string("--") + kExperiments[i].task + "-profile", flags->profiles[i],
                        std::string("deformation measured in a ") + kExperiments[i].task +
                            " (CSV: r_mm, u_mm, depth_mm), to show beside figure 7 with its absolute error");
  }
  command->add_flag("--json", flags->json, "summary as one JSON document");
  command->footer("Example: palpate demo --report out");
  command->callback([flags, &command_line, &exit_code] { exit_code = demo(*flags, command_line); });
}

}  // namespace palpate::app
