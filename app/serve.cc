// `palpate serve`: serves the live interface, by which other programs watch and control runs
// (docs/live-interface.md). `palpate run --page`: the same for one browser on this computer.
#include "app/serve.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "io/system/plugin.h"
#include "net/live_access.h"
#include "net/live_server.h"
#include "palpate/error.h"
#include "run/session/usable_core.h"

#include "app/browser.h"
#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/scene_flags.h"
#include "app/served_devices.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr int kPort = 7370;

struct ServeFlags {
  ServedOptions runs;
  net::LiveOptions server;
  int port = kPort;
  fs::path token_file;
  fs::path page;
  bool new_token = false;
  bool wait = false;
  bool browser = false;  // opens the page in a browser of this computer
};

// Media types by file name extension. Files with other extensions are not sent.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kPageTypes = {
    {{".html", "text/html; charset=utf-8"},
     {".js", "text/javascript; charset=utf-8"},
     {".css", "text/css; charset=utf-8"},
     {".wasm", "application/wasm"},
     {".txt", "text/plain; charset=utf-8"},
     {".svg", "image/svg+xml"},
     {".png", "image/png"}}};
constexpr std::size_t kMaxPageFiles = 100;

/// The files of a page by their path at the server: an HTML file, or those of a folder with an index.html.
/// They are read once, so that a request opens no file. @throws InputError
std::map<std::string, net::PageFile> read_page(const fs::path& page) try {
  if (!folder_exists(page)) {
    return {{"/", {std::string(kPageTypes[0].second), InputFile(page, kPageInput).read_rest()}}};
  }
  std::map<std::string, net::PageFile> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(page)) {
    const auto type = std::find_if(kPageTypes.begin(), kPageTypes.end(), [&](const auto& known) {
      return entry.path().extension() == known.first;
    });
    if (type == kPageTypes.end() || entry.symlink_status().type() != fs::file_type::regular) continue;
    if (files.size() == kMaxPageFiles) {
      throw InputError(fmt::format("{}: has more than {} files", to_text(page), kMaxPageFiles));
    }
    const std::string path = "/" + entry.path().lexically_relative(page).generic_string();
    files[path == "/index.html" ? "/" : path] = {std::string(type->second),
                                                 InputFile(entry.path(), kPageInput).read_rest()};
  }
  if (files.count("/") == 0) throw InputError(to_text(page) + ": this folder has no index.html");
  return files;
} catch (const std::exception& error) {
  throw InputError(std::string("--page ") + error.what());
}

/// Server options of the flags: address, port, page, and the token that clients need. @throws InputError
net::LiveOptions server_options(const ServeFlags& flags) {
  net::LiveOptions options = flags.server;
  options.log = [](const std::string& line) { report_message(line); };
  if (flags.port < 0 || flags.port > 65535) {
    throw ParameterError("--port", flags.port, "0 (the system chooses) to 65535");
  }
  options.port = static_cast<std::uint16_t>(flags.port);
  if (!flags.page.empty()) options.page = read_page(flags.page);
  if (!flags.token_file.empty() && flags.new_token) {
    throw InputError("--new-token: --token-file " + to_text(flags.token_file) + " already gives a token");
  }
  if (!flags.token_file.empty()) options.token = net::read_token_file(flags.token_file);
  if (flags.new_token) options.token = net::new_token();
  return options;
}

/// The folder of the page in a Windows zip, an installation or a build; a build without the page's own
/// picture has its plain version. @throws InputError
fs::path page_of_program() {
  const fs::path program = folder_of_program();
  for (const char* const place :
       {"page", "../share/palpate/page", "../../page/live", "../../../examples/live"}) {
    const fs::path folder = (program / place).lexically_normal();
    if (!program.empty() && file_exists(folder / "index.html")) return folder;
  }
  throw InputError(
      "--page: this installation has no page: palpate serve --page index.html serves one of your own");
}

void check_runs(const ServedOptions& options) {
  session::require_usable_core(options.thread.core, "--core");
  if (!options.recording.empty()) require_regular_file(options.recording, "--record");
  if (!options.scenes.empty() && !folder_exists(options.scenes)) {
    throw InputError("--scenes " + to_text(options.scenes) + ": is not a folder");
  }
}

/// Reports the server's address on standard error. With --json it also prints the first JSON line on standard
/// output.
void report_place(const net::LiveServer& server, const ServeFlags& flags, const net::LiveOptions& options) {
  const std::string place = fmt::format("{}:{}", server.host(), server.port());
  report_message("serving ws://" + place + "/; Ctrl-C ends the server");
  const std::string page = "http://" + place + "/" + (flags.browser ? "#" + options.token : "");
  if (!options.page.empty()) report_message("the page for a browser is at " + page);
  if (flags.browser && !open_in_browser(page)) {
    report_message("open it in a browser of this computer; from another one: ssh -L " +
                   fmt::format("{0}:127.0.0.1:{0} HOST, then there", server.port()));
  }
  if (flags.new_token && !flags.browser) report_message("token for hello: " + options.token);
  if (!flags.runs.json) return;
  nlohmann::ordered_json line{{"address", server.host()}, {"port", server.port()}};
  if (flags.new_token) line["token"] = options.token;
  std::cout << net::text_of({{"listening", line}}) << std::endl;
}

void report_account(const net::LiveStatistics& account, std::uint64_t runs, bool json) {
  if (json) {
    std::cout << net::text_of({{"served",
                                {{"runs", runs},
                                 {"connections", account.connections},
                                 {"refused", account.refused},
                                 {"messages", account.messages},
                                 {"errors", account.errors},
                                 {"frames", account.frames},
                                 {"left_out", account.left_out}}}})
              << std::endl;
    return;
  }
  std::cout << "Served " << account.connections << " connections (" << account.refused << " refused), "
            << account.messages << " messages (" << account.errors << " with errors), " << account.frames
            << " frames (" << account.left_out << " skipped)\n";
}

int serve(const ServeFlags& flags) {
  const StopOnSignal signals;
  const BackgroundOutput output;
  const net::LiveOptions options = server_options(flags);
  check_runs(flags.runs);
  scene::Scene scene = load_scene(flags.runs.request, flags.runs.no_cache);
  if (!flags.runs.page) require_windowless(scene);
  std::vector<NamedFile> inputs = sources_of(scene);
  inputs.push_back({"--page", flags.page});
  inputs.push_back({"--token-file", flags.token_file});
  require_no_overwrite(std::vector<NamedFile>{{"--record", flags.runs.recording}}, inputs);
  ServedRuns runs(flags.runs,
                  prepare(std::move(scene), flags.runs.duration_s, flags.runs.no_cache, &signals.flag()));
  net::LiveServer server(options, runs);
  runs.stop_with(signals.flag());
  report_place(server, flags, options);
  if (!flags.wait) runs.begin_first();
  server.run(signals.flag());
  runs.finish();
  report_account(server.statistics(), runs.runs(), flags.runs.json);
  if (runs.fault()) return kFault;
  return runs.failed() ? kBadInput : kDone;
}

void add_serve_flags(CLI::App& command, ServeFlags& flags) {
  command.add_option(
      "--listen", flags.server.address,
      "address to listen at (default 127.0.0.1); one that other machines can reach needs a token");
  command.add_option("--port", flags.port, "port (default 7370); 0: the system chooses");
  command.add_option("--token-file", flags.token_file,
                     "clients must send the token in the first line of this file");
  command.add_flag("--new-token", flags.new_token, "make and print a token that clients must send");
  command
      .add_option(
          "--allow-origin", flags.server.origins,
          "allow pages of this origin to connect, e.g. http://localhost:8000; repeat the flag for more")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--page", flags.page,
                     "HTML file, or folder with index.html, that the server sends to browsers");
  command.add_option("--scenes", flags.runs.scenes,
                     "clients may load files in this folder and its subfolders");
  command.add_flag("--wait", flags.wait, "do not begin a run until a client sends start");
  command.add_flag("--stop-when-alone", flags.runs.stop_when_alone,
                   "end the run when the last client disconnects");
  command.add_option("--record", flags.runs.recording,
                     "write the first run's ticks to this HDF5 file; the files of later runs get a number");
  command.add_option("--duration-s", flags.runs.duration_s,
                     "simulated time of each run: exactly round(S x rate) ticks");
  add_thread_flags(command, flags.runs.thread);
  command.add_flag("--no-cache", flags.runs.no_cache, kNoCacheHelp);
  command.add_flag("--json", flags.runs.json, "one JSON document per line: listening, each run, served");
}

}  // namespace

int serve_page(ServedOptions runs) {
  ServeFlags flags;
  flags.runs = std::move(runs);
  flags.runs.stop_when_alone = flags.runs.page = true;
  flags.port = 0;
  flags.page = page_of_program();
  flags.new_token = flags.browser = flags.wait = true;  // a page that is open begins the run
  return serve(flags);
}

void add_serve(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "serve", "Serve the live interface: programs and web pages watch and control a run");
  auto flags = std::make_shared<ServeFlags>();
  add_scene_flags(*command, flags->runs.request);
  add_serve_flags(*command, *flags);
  command->footer(
      "Example: palpate serve --device emulated --page examples/live/index.html\n"
      "         then open http://127.0.0.1:7370/ in a browser, or run python3 "
      "examples/python/live_client.py\n"
      "A WebSocket with one JSON object per message (docs/live-interface.md). The first run begins at once\n"
      "and continues when clients connect or disconnect. After its end clients may start the next run.\n"
      "Ctrl-C ends the server.\n"
      "Exit: 0 done, 2 bad input, 3 a fault was latched (even if it was reset)");
  command->callback([flags, &exit_code] { exit_code = serve(*flags); });
}

}  // namespace palpate::app
