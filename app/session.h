#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/system/output_file.h"
#include "net/igtl_server.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/session.h"

#include "app/signals.h"
#include "app/summary.h"

namespace CLI {
class App;
}

namespace palpate::app {

using session::RunResult;
using session::Session;

/// The user or a client ended the preparation of a run. That is no failure.
class Cancelled final : public InputError {
 public:
  Cancelled() : InputError("stopped before the run began") {}
};

/// [setup] Loads a scene with the user's cache. @param no_cache ignores it @throws as scene::load()
[[nodiscard]] scene::Scene load_scene(scene::Overrides request, bool no_cache);

/// [setup] Opens a session and shows a progress bar while its organ is prepared. @param duration_s simulated
/// time [s], rounded to whole ticks; nullopt: until the devices have no more samples @param no_cache ignores
/// the cache of prepared organs @param broken_off cancels the preparation: after another thread or a signal
/// has set it, the next stage of the preparation throws Cancelled @throws InputError; ParameterError naming
/// --duration-s.
[[nodiscard]] std::unique_ptr<Session> prepare(scene::Scene scene, std::optional<double> duration_s,
                                               bool no_cache, const std::atomic<bool>* broken_off = nullptr);

/// [setup] Checks that a file can be written, without creating or changing it. @throws InputError naming
/// `flag` and the path.
void require_writable_file(const std::filesystem::path& file, const std::string& flag);
/// [setup] Checks a file as require_writable_file() does, and rejects a device file and a FIFO: a recording
/// is renamed to its final name, and a film is not written sequentially. @throws InputError
void require_regular_file(const std::filesystem::path& file, const std::string& flag);
/// [setup] Checks a file as require_writable_file() does, and that its name does not promise another format
/// than PNG. @throws InputError
void require_png_file(const std::filesystem::path& file, const std::string& flag);
/// [setup] Checks that a folder, or the folder in which it would be made, is writable. @throws InputError
void require_writable_folder(const std::filesystem::path& folder, const std::string& flag);

/// [setup] Checks that no other output and no input has a name in the report's folder that the report may
/// write. @param report its folder; empty: there is none @throws InputError naming the file and its flag
void require_none_of_report(const std::filesystem::path& report, std::span<const NamedFile> files);

/// [setup] The files from which a scene was read. No output may replace them.
[[nodiscard]] std::vector<NamedFile> sources_of(const scene::Scene& scene);

/// [setup] Adds --core and --poll to a command.
void add_thread_flags(CLI::App& command, haptics::LoopThread& thread);

/// How a session is played.
struct PlayOptions {
  session::RunOptions run;
  std::vector<haptics::TickObserver*> observers;  // e.g. a window or clients; they outlive the run
  net::IgtlServer* igtl = nullptr;          // server that shows the run to OpenIGTLink clients; may be null
  const std::atomic<bool>* stop = nullptr;  // ends the run, e.g. Ctrl-C; null: the caller ends it
};

/// [setup] Runs a session to its end, with a progress bar on a terminal. A latched fault is reported on
/// standard error while the run continues at zero force. A recording that can no longer be written is also
/// reported. SIGUSR1 resets the faults of all hands. @throws InputError when the recording cannot be made.
[[nodiscard]] RunResult play(Session& session, const PlayOptions& how);

/// [setup] Calls play() on a new thread. Destroying the result stops the run and waits for its end.
[[nodiscard]] std::unique_ptr<session::BackgroundRun> play_in_background(Session& session, PlayOptions how);

/// [setup] Exit code of a run: 3 after a fault, even if it was reset; 2 when the recording is incomplete; 4
/// when more deadlines were missed than `max_missed`; otherwise 0.
[[nodiscard]] int exit_code_of(const RunResult& run, std::optional<std::uint64_t> max_missed);

/// [setup] Title of a run, e.g. "Gallbladder pressed with curved-forceps".
[[nodiscard]] std::string title_of(const scene::Scene& scene);

/// Help text of --break-blind.
inline constexpr const char* kBreakBlindHelp =
    "open a recording of a study that is still blind; blind-broken.jsonl beside it keeps a note";

/// [setup] Reads a recording for a command that shows its forces. @param break_blind the flag --break-blind
/// was given @throws InputError as record::read_recording() and record::break_blind()
[[nodiscard]] inline record::Recording read_to_show(const std::filesystem::path& file, const char* command,
                                                    bool break_blind, const record::Progress& progress = {}) {
  return break_blind ? record::break_blind(file, command, progress) : record::read_recording(file, progress);
}

}  // namespace palpate::app
