#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/system/output_file.h"
#include "net/igtl_server.h"
#include "palpate/offscreen.h"
#include "palpate/recording.h"
#include "palpate/session.h"

#include "app/summary.h"

namespace CLI {
class App;
}

namespace palpate::app {

using session::RunResult;
using session::Session;

/// [setup] Opens a session and shows a progress bar while its organ is prepared. @param duration_s simulated
/// time [s], rounded to whole ticks; none: until the devices have no more samples. @param no_cache ignores
/// the cache of prepared organs. @param broken_off once another thread has set it, the organ's next stage
/// ends with an InputError @throws InputError; ParameterError naming --duration-s.
[[nodiscard]] std::unique_ptr<Session> prepare(scene::Scene setup, std::optional<double> duration_s,
                                               bool no_cache, const std::atomic<bool>* broken_off = nullptr);

/// [setup] Whether a file or folder could be written there, without touching anything. @throws InputError
/// naming `flag` and the path.
void require_writable_file(const std::filesystem::path& file, const std::string& flag);
/// [setup] As require_writable_file(), and that no device or FIFO stands there: a recording is renamed to its
/// name, a film is written with jumps.
void require_regular_file(const std::filesystem::path& file, const std::string& flag);
void require_writable_folder(const std::filesystem::path& folder, const std::string& flag);

/// [setup] The files that a scene was read from, which no output may replace.
[[nodiscard]] std::vector<NamedFile> sources_of(const scene::Scene& setup);

/// Ctrl-C and SIGTERM end the run in good order while this lives; the second one ends the program.
class StopOnSignal final {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  [[nodiscard]] const std::atomic<bool>& flag() const noexcept;
};

/// [setup] Gives a command --core and --poll.
void add_thread_flags(CLI::App& command, haptics::LoopThread& thread);

/// How a session is played.
struct PlayOptions {
  session::RunOptions run;
  std::vector<haptics::TickObserver*> observers;  // a window, clients; they outlive the run
  net::IgtlServer* igtl = nullptr;                // shows the run to other programs
  const std::atomic<bool>* stop = nullptr;        // Ctrl-C; null: whoever plays the session looks after it
};

/// [setup] Runs a session to its end, with a progress bar on a terminal. Each latched fault is
/// reported on standard error while the run continues at zero force, so is a recording that cannot be written
/// any more; SIGUSR1 clears the faults of all hands. @throws InputError when the recording cannot be made.
[[nodiscard]] RunResult play(Session& session, const PlayOptions& how);

/// [setup] Calls play() on a new thread. Destroying the result stops the run and waits for its end.
[[nodiscard]] std::unique_ptr<session::BackgroundRun> play_in_background(Session& session, PlayOptions how);

/// [setup] Exit code of a run: 3 with a fault, also one that was reset, 2 when its recording ends early, 4
/// past the missed deadlines allowed, else 0.
[[nodiscard]] int exit_code_of(const RunResult& run, std::optional<std::uint64_t> max_missed);

/// [setup] "Gallbladder pressed with curved-forceps".
[[nodiscard]] std::string title_of(const scene::Scene& setup);

/// [setup] The picture of a recording's deepest moment as a PNG. @throws InputError when it cannot be
/// written, std::runtime_error without OpenGL. @param no_cache as for prepare().
void write_screenshot(const record::Recording& recording, const session::RunStatistics& statistics,
                      const std::filesystem::path& file, bool no_cache);

}  // namespace palpate::app
