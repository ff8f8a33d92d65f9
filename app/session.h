#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/haptics/loop.h"
#include "palpate/net/igtl_server.h"
#include "palpate/record/recording.h"
#include "palpate/render/offscreen.h"
#include "palpate/scene/load.h"

#include "app/summary.h"

namespace CLI {
class App;
}

namespace palpate::app {

/// A scene, checked and ready to run; nothing has been written yet.
struct Session {
  scene::Setup setup;
  haptics::SimulationWorld world;
  std::vector<std::unique_ptr<haptics::Device>> devices;
  std::uint64_t ticks = 0;  // 2^64-1: until Ctrl-C
};

/// [setup] Reads and checks all inputs. @param duration_s exactly round(duration x rate) ticks; none: until
/// the devices have nothing more to say. @param no_cache the organ is prepared anew. @throws InputError.
[[nodiscard]] Session prepare(const scene::Request& request, std::optional<double> duration_s, bool no_cache);

/// [setup] The same from a scene that is read already.
[[nodiscard]] Session prepare(scene::Setup setup, std::optional<double> duration_s, bool no_cache);

/// [setup] Whether a file or folder could be written there, without touching anything. @throws InputError
/// naming `flag` and the path.
void require_writable_file(const std::filesystem::path& file, const std::string& flag);
void require_writable_folder(const std::filesystem::path& folder, const std::string& flag);

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
  std::filesystem::path recording;  // file to write; empty: none
  bool offline = false;
  haptics::LoopThread thread{};             // of the loop
  haptics::LiveChanges* changes = nullptr;  // to tissue and noise while the session is played
  // For who watches the run, a window; they outlive it:
  SnapshotCell<haptics::Snapshot>* snapshots = nullptr;
  haptics::TickSink* onlooker = nullptr;     // sees every row, too
  net::IgtlServer* igtl = nullptr;           // shows the run to other programs
  const std::atomic<bool>* pause = nullptr;  // LoopOptions::pause
};

/// [any] Whether a session may be paused: no hand holds one of its devices.
[[nodiscard]] bool may_pause(const Session& session);

/// [any] Clears the faults of all hands of the session that plays, as SIGUSR1 does.
void reset_faults() noexcept;

/// [setup] Refuses a core that this program may not use. @throws ParameterError naming --core and the cores.
void require_usable_core(std::optional<int> core);

/// [setup] Runs a session to its end, with a progress bar on a terminal. A fault that is latched is told on
/// standard error while the run goes on at zero force; SIGUSR1 clears the faults of all hands.
/// @throws InputError when the recording cannot be written.
[[nodiscard]] RunAccount play(Session& session, const PlayOptions& how, const std::atomic<bool>& stop);

/// [setup] Exit code of a run: 3 with a fault, also one that was reset, 4 past the missed deadlines allowed,
/// else 0.
[[nodiscard]] int exit_code_of(const RunAccount& run, std::optional<std::uint64_t> max_missed);

/// [setup] "Gallbladder pressed with curved-forceps".
[[nodiscard]] std::string title_of(const scene::Setup& setup);

/// [setup] The picture of a recording's deepest moment as a PNG. @throws InputError when it cannot be
/// written, std::runtime_error without OpenGL. @param no_cache as for prepare().
void write_screenshot(const record::Recording& recording, const Highlights& highlights,
                      const std::filesystem::path& file, bool no_cache);

}  // namespace palpate::app
