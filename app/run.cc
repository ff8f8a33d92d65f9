// `palpate run`: runs one interaction, in real time or offline.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/system/file_exists.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "net/igtl_server.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "run/session/usable_core.h"
#include "view/report/page.h"
#include "view/report/report.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "app/scene_flags.h"
#include "app/serve.h"
#include "app/session.h"
#include "app/summary.h"
#include "app/window/run_in_window.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// Help text of --igtl.
constexpr const char* kIgtlHelp =
    "[ADDRESS:]PORT: show the run to 3D Slicer and other OpenIGTLink clients, on this machine only unless "
    "ADDRESS is 0.0.0.0 or an address of this machine in a network";

/// The server that --igtl asks for. It sends the state of each run to OpenIGTLink clients such as 3D Slicer.
/// Without --igtl there is no server. All members: [setup].
class IgtlService final {
 public:
  /// Starts to listen. @param where value of --igtl, [ADDRESS:]PORT; nullopt: no server
  /// @throws InputError naming --igtl when the value is invalid or the server cannot listen at it.
  explicit IgtlService(const std::optional<std::string>& where) {
    if (!where) return;
    address_ = net::parse_igtl_address(*where);
    server_ = std::make_unique<net::IgtlServer>(address_);
  }

  /// Null without --igtl.
  [[nodiscard]] net::IgtlServer* server() noexcept { return server_.get(); }

  /// Reports the server's address, and whether other machines can reach it, on standard error.
  void report_where() const {
    if (server_ == nullptr) return;
    const std::string port = std::to_string(address_.port);
    const bool local = address_.host.rfind("127.", 0) == 0;
    report_message(fmt::format(
        "OpenIGTLink: listening at {}:{}{}", address_.host, port,
        local ? ", for programs on this machine only (for other machines: --igtl 0.0.0.0:" + port + ")"
              : ": anyone who can reach it over the network can see the run; there is no password"));
  }

  /// Call it after the last run. Ends the server and reports its statistics. @return the statistics; nullopt
  /// without a server
  std::optional<net::IgtlStatistics> finish() {
    if (server_ == nullptr) return std::nullopt;
    net::IgtlStatistics tally = server_->finish();
    server_.reset();
    std::string text = fmt::format("OpenIGTLink: {}, {} sent, {} skipped for slow clients",
                                   counted(tally.clients, "client", "clients"),
                                   counted(tally.frames, "frame", "frames"), tally.frames_left_out);
    if (tally.given_up > 0)
      text += fmt::format("; {} disconnected because they no longer received data", tally.given_up);
    if (tally.refused > 0)
      text += fmt::format("; {} refused because too many clients were connected", tally.refused);
    if (!tally.failure.empty()) text += "; the server ended early: " + tally.failure;
    report_message(text);
    return tally;
  }

 private:
  net::IgtlAddress address_;
  std::unique_ptr<net::IgtlServer> server_;
};

struct RunFlags {
  scene::Overrides request;
  bool offline = false;
  bool headless = false;
  bool page = false;
  bool json = false;
  bool no_cache = false;
  std::optional<double> duration_s;
  std::optional<std::uint64_t> max_missed;
  std::optional<std::string> igtl;
  haptics::LoopThread thread;
  std::string ui_scale;
  fs::path profile;  // measured; empty: none
  OutputFiles files;
};

void check_outputs(const OutputFiles& files, const scene::Scene& scene, const fs::path& profile) {
  if (!files.recording.empty()) require_regular_file(files.recording, "--record");
  if (!files.screenshot.empty()) require_png_file(files.screenshot, "--screenshot");
  if (!files.report.empty()) require_pictures("--report");
  if (!files.report.empty()) require_writable_folder(files.report, "--report");
  std::vector<NamedFile> inputs = sources_of(scene);
  inputs.push_back({"--profile", profile});
  std::vector<NamedFile> outputs = {{"--record", files.recording}, {"--screenshot", files.screenshot}};
  require_none_of_report(files.report, outputs);
  require_none_of_report(files.report, inputs);
  if (!files.report.empty()) outputs.push_back({"--report", files.report / "report.html"});
  if (!files.report.empty() && files.recording.empty()) {
    require_regular_output(files.report / "recording.h5", "--report");
    outputs.push_back({"--report", files.report / "recording.h5"});
  }
  require_no_overwrite(outputs, inputs);
}

/// Rejects the name of a built-in organ in place of a scene file. @throws InputError
void require_no_organ_name(const fs::path& scene) {
  const std::vector<std::string>& organs = geometry::builtin_organ_names();
  if (std::find(organs.begin(), organs.end(), to_text(scene)) == organs.end() || file_exists(scene)) return;
  throw InputError(to_text(scene) + ": is a built-in organ, must be a scene file: palpate run --organ " +
                   to_text(scene));
}

/// Whether this run has a window. Reports a missing display for a run in real time without --headless.
bool wants_window(const RunFlags& flags) {
  if (flags.headless || flags.offline) return false;
  if (display_there()) return true;
  report_message(std::string(describe_no_display()) +
                 ": the run has no window (--headless omits this message)");
  return false;
}

/// Rejects a mouse or a gamepad without a window, because the window supplies their input. @throws InputError
void require_window(const Session& session, const RunFlags& flags, bool window) {
  if (window) return;
  for (const scene::DeviceSetup& device : session.scene().devices) {
    const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
    if (kind == nullptr || !kind->window) continue;
    const std::string why = flags.offline    ? "with --offline"
                            : flags.headless ? "with --headless"
                                             : "without a display";
    throw InputError("device " + device.kind + ": needs the window of the run, and there is none " + why +
                     "; in a browser: palpate run --page --device " + device.kind);
  }
}

/// Whether the flags ask for an output. The window then closes at the end of the run, because outputs are
/// written after it has closed.
bool wants_outputs(const RunFlags& flags) {
  return flags.json || flags.duration_s || flags.max_missed || !flags.files.recording.empty() ||
         !flags.files.report.empty() || !flags.files.screenshot.empty();
}

/// Result of the first run, and the events of later runs in its window.
struct Played {
  RunResult result;
  bool later_fault = false;               // a later run in the window latched a fault
  bool display_lost = false;              // the display closed during a run
  std::vector<SearchOutcome> searches{};  // of tasks palpate and insert, in the window
};

/// The scores of the searches in a window. Where the window missed rows, the score is of the recording.
void complete_scores(std::vector<SearchOutcome>& searches, bool no_cache) {
  for (SearchOutcome& search : searches) {
    if (search.rows_left_out == 0) continue;
    if (search.recording.empty() || !file_exists(search.recording)) {
      report_message(fmt::format("a search's score lacks {} rows that the window was too slow for",
                                 search.rows_left_out));
      continue;
    }
    search.score = any_score_of(record::read_recording(search.recording), no_cache);
  }
}

void print_searches(const std::vector<SearchOutcome>& searches) {
  for (std::size_t i = 0; i < searches.size(); ++i) {
    const SearchOutcome& search = searches[i];
    if (searches.size() > 1) std::cout << fmt::format("\nsearch {}, seed {}\n", i + 1, search.seed);
    if (searches.size() > 1 && !search.recording.empty()) {
      std::cout << fmt::format("{:<20}{}\n", "recording", to_text(search.recording));
    }
    const auto* found = std::get_if<palpation::Score>(&search.score);
    if (found != nullptr && found->contact_time == 0.0) {
      std::cout << "the tissue was never touched\n";
    } else {
      print_score(std::cout, search.score);
    }
  }
}

nlohmann::ordered_json searches_json(const std::vector<SearchOutcome>& searches) {
  auto list = nlohmann::ordered_json::array();
  for (const SearchOutcome& search : searches) {
    nlohmann::ordered_json one = {{"seed", search.seed}, {"recording", nullptr}};
    if (!search.recording.empty()) one["recording"] = to_text(search.recording);
    one["score"] = nlohmann::ordered_json::parse(palpation::to_json(search.score));  // its own JSON
    list.push_back(std::move(one));
  }
  return list;
}

Played play_in_window(const std::shared_ptr<Session>& session, const RunFlags& flags,
                      const fs::path& recording, net::IgtlServer* igtl, const std::atomic<bool>& stop) {
  WindowOptions options;
  options.recording = recording;
  options.thread = flags.thread;
  options.duration_s = flags.duration_s;
  options.no_cache = flags.no_cache;
  options.stays = !wants_outputs(flags);
  options.scale = UiScale::asked(flags.ui_scale);
  options.stop = &stop;
  options.igtl = igtl;
  WindowOutcome outcome = run_in_window(session, flags.request, options);
  const auto in_ms = [](double time) { return shortest(std::round(1e3 * time)) + " ms"; };
  report_message("the window showed " + std::to_string(outcome.frames) +
                 " frames of the run; median age of the shown state " + in_ms(outcome.median_age) +
                 ", largest age " + in_ms(outcome.largest_age));
  if (outcome.more_runs > 0) {
    report_message(std::to_string(outcome.more_runs) + " more run" + (outcome.more_runs > 1 ? "s" : "") +
                   " in the window; the summary is of the first run");
  }
  complete_scores(outcome.searches, flags.no_cache);
  return {std::move(outcome.result), outcome.later_fault, outcome.display_lost, std::move(outcome.searches)};
}

/// Plays the session in a window, or without one when none can be opened.
Played play_as_asked(const std::shared_ptr<Session>& session, const RunFlags& flags,
                     const fs::path& recording, bool window, net::IgtlServer* igtl,
                     const std::atomic<bool>& stop) {
  const BackgroundOutput output;
  if (window) {
    try {
      return play_in_window(session, flags, recording, igtl, stop);
    } catch (const NoWindow& error) {
      report_message(std::string(error.what()) + "; the run has no window");
      require_window(*session, flags, false);
    }
  }
  PlayOptions how;
  how.run = {recording, flags.offline, flags.thread};
  how.igtl = igtl;
  how.stop = &stop;
  return {play(*session, how), false, false, {}};
}

/// Prints the scene's remarks before a run that takes minutes or has no end; a shorter one ends with them.
void report_long_run(const Session& session, const RunFlags& flags) {
  constexpr double kLong = 120.0;  // s
  if (flags.offline || static_cast<double>(session.ticks()) < kLong * session.scene().rate_Hz) return;
  for (const std::string& remark : session.scene().remarks) report_message(remark);
}

int run(const RunFlags& flags, const std::string& command_line) {
  if (flags.request.scene) require_no_organ_name(*flags.request.scene);
  if (flags.page) {
    return serve_page({.request = flags.request,
                       .scenes = {},
                       .recording = flags.files.recording,
                       .duration_s = flags.duration_s,
                       .thread = flags.thread,
                       .no_cache = flags.no_cache,
                       .json = flags.json});
  }
  std::optional<StopOnSignal> signals(std::in_place);
  IgtlService igtl(flags.igtl);
  session::require_usable_core(flags.thread.core, "--core");
  (void)UiScale::asked(flags.ui_scale);  // checks the value before anything else is done
  std::optional<report::ReferenceProfile> profile;
  if (!flags.profile.empty()) profile = report::read_measured_profile(flags.profile);
  scene::Scene scene = load_scene(flags.request, flags.no_cache);
  check_outputs(flags.files, scene, flags.profile);
  const std::shared_ptr<Session> session =
      prepare(std::move(scene), flags.duration_s, flags.no_cache, &signals->flag());
  const bool window = wants_window(flags);
  require_window(*session, flags, window);
  OutputFiles files = flags.files;

  // Holds a recording that is needed only for the screenshot or the score.
  std::optional<ScratchFolder> temporary;
  if (!files.report.empty()) {
    report::make_report_folder(files.report);
    if (files.recording.empty()) files.recording = files.report / "recording.h5";
  }
  fs::path recorded = files.recording;
  const scene::Task task = session->scene().task;
  const bool has_score = task == scene::Task::kPalpate || task == scene::Task::kInsert;
  if (recorded.empty() && ((has_score && !window) || !files.screenshot.empty())) {
    const fs::path folder = temporary.emplace("palpate-").path();
    if (folder.empty()) throw InputError(to_text(fs::temp_directory_path()) + ": cannot make a folder in it");
    recorded = folder / "run.h5";
  }

  const std::string title = title_of(session->scene());
  igtl.report_where();
  report_long_run(*session, flags);
  const Played played = play_as_asked(session, flags, recorded, window, igtl.server(), signals->flag());
  signals.reset();
  const std::optional<net::IgtlStatistics> tally = igtl.finish();
  const RunResult& result = played.result;
  bool draw = result.loop.ticks > 0 && !(files.report.empty() && files.screenshot.empty());
  // SDL keeps its connection to a lost display and cannot open another, so no picture can be drawn.
  if (draw && (played.display_lost || !result.recording_failure.empty())) {
    report_message(
        (played.display_lost ? "no pictures can be drawn without a display" : "the recording is incomplete") +
        std::string(": no report and no screenshot were written") +
        (files.recording.empty() || !file_exists(files.recording)
             ? std::string()
             : "; to draw one: palpate view " + to_text(files.recording) + " --screenshot FILE.png"));
    draw = false;
    files.report.clear();
    files.screenshot.clear();
  }
  std::optional<palpation::AnyScore> score;
  if (!played.searches.empty()) score = played.searches.front().score;
  const bool scores =
      has_score && !score && !recorded.empty() && result.loop.ticks > 0 && result.recording_failure.empty();
  if (draw || scores) {
    record::Recording recording = record::read_recording(recorded);
    recording.scene.store = OrganPreparation(flags.no_cache).how().store;
    if (scores) score = any_score_of(recording, flags.no_cache);
    if (draw && !files.screenshot.empty())
      write_screenshot(recording, result.statistics, files.screenshot, flags.no_cache);
    if (draw && !files.report.empty()) {
      Progress bar("report", WithoutTerminal::kSteps);
      files.report =
          report::write_report({{title, &recording, command_line, 0.0, profile}}, files.report,
                               [&bar](double done, const std::string& what) { bar.update(done, what); });
    }
  }
  if (flags.json) {
    nlohmann::ordered_json summary = summary_json(result, files, tally);
    if (score) summary["score"] = nlohmann::ordered_json::parse(palpation::to_json(*score));  // its own JSON
    if (played.searches.size() > 1) summary["searches"] = searches_json(played.searches);
    std::cout << json_text(summary) << '\n';
  } else {
    print_summary(std::cout, result, files);
    if (!played.searches.empty()) {
      print_searches(played.searches);
    } else if (score) {
      print_score(std::cout, *score);
    }
  }
  const int code = exit_code_of(result, flags.max_missed);
  return played.later_fault ? kFault : code;
}

void add_run_flags(CLI::App& command, RunFlags& flags) {
  command.add_flag("--offline", flags.offline,
                   "run as fast as possible; the rows are the same as in real time");
  command.add_option("--duration-s", flags.duration_s, "simulated time: exactly round(S x rate) ticks");
  command.add_option("--record", flags.files.recording, "write every tick to this HDF5 file");
  command.add_option("--report", flags.files.report, "write report.html and its figures to this folder");
  command
      .add_option("--profile", flags.profile,
                  "with --report: deformation measured around a contact (CSV: r_mm, u_mm, depth_mm), to show "
                  "beside this run's with its absolute error")
      ->needs("--report");
  command.add_option("--screenshot", flags.files.screenshot, "write a PNG picture of the deepest contact");
  command.add_flag("--headless", flags.headless, "no window, even if there is a display");
  command.add_flag("--page", flags.page,
                   "a page in a browser of this computer in place of the window, also without a display");
  command.add_option("--ui-scale", flags.ui_scale,
                     "size of the window's text and panels, 0.5 to 4 (default: from the display)");
  command.add_option("--max-missed", flags.max_missed,
                     "exit with code 4 when more deadlines than this were missed");
  add_thread_flags(command, flags.thread);
  command.get_option("--poll")->excludes("--offline");
  command.add_option("--igtl", flags.igtl, kIgtlHelp);
  command.add_flag("--no-cache", flags.no_cache, kNoCacheHelp);
  command.add_flag("--json", flags.json, "summary as one JSON document");
  for (const char* const other :
       {"--offline", "--headless", "--report", "--screenshot", "--igtl", "--max-missed", "--ui-scale"})
    command.get_option("--page")->excludes(other);
}

}  // namespace

void add_run(CLI::App& program, const std::string& command_line, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("run", "Run one interaction: touch an organ, feel it, see it and record it");
  auto flags = std::make_shared<RunFlags>();
  add_scene_flags(*command, flags->request);
  add_run_flags(*command, *flags);
  command->footer(
      std::string("Example: palpate run --organ liver.stl --organ-unit mm --tissue liver --tool sphere:3 \\\n"
                  "           --record liver.h5 --report out\n") +
      describe_faults() +
      "Exit: 0 done, 2 bad input, 3 a fault was latched (even if it was reset),\n"
      "      4 more than --max-missed deadlines missed");
  command->callback([flags, &command_line, &exit_code] {
    flags->request.igtl = flags->igtl.has_value();
    exit_code = run(*flags, command_line);
  });
}

}  // namespace palpate::app
