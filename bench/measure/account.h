#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/times.h"

namespace palpate::bench {

/// How far a measurement is (0..1) and what is being measured.
using Watch = std::function<void(double share, const std::string& what)>;

/// One whole tick: pose in, force and torque out after the gate, the row in the recorder's ring.
struct TickAccount {
  std::string scene;
  std::string phase;  // press | pull: what the task does in contact
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
  TimeFigures contact;
  TimeFigures approach;  // within 20 mm
  // The path is followed `repeats` times and every tick is the same each time. Its least time is its own;
  // what single times have more, the machine adds: interrupts, and caches and tables to fill again
  // afterwards.
  int repeats = 0;
  TimeFigures contact_least;
  TimeFigures approach_least;
};

/// One exact nearest point of the organ, asked along the way of the tool's tip.
struct NearestAccount {
  std::size_t organ_triangles = 0;
  TimeFigures times;
};

/// All that is made of an organ before its first tick: refined surface, normals, tree.
struct PreparationAccount {
  std::string organ;
  std::size_t organ_triangles = 0;
  double seconds = 0.0;   // wall time
  std::size_t bytes = 0;  // that stay
};

/// Independent hands on one organ at 1 kHz, one thread a core, all at once.
struct HandsRun {
  std::size_t hands = 0;  // of all threads; 0: none ran
  std::size_t threads = 0;
  std::uint64_t periods = 0;   // of all threads
  std::uint64_t missed = 0;    // of them, that began a full one late
  std::uint64_t lost = 0;      // rows that found the ring full
  TimeFigures round;           // of one thread's hands in one period: processor time
  TimeFigures wall;            // from the period's begin of work to its end
  double worst_p999_us = 0.0;  // p99.9 of `round`, of the thread where that is greatest
};

/// Many hands in one process.
struct HandsAccount {
  std::size_t hands_per_core = 0;  // inside 80 % of the period at p99.9 on every core
  double bytes_per_hand = 0.0;     // beyond the shared organ
  HandsRun most;                   // with `hands_per_core` on each
  HandsRun asked;                  // as many as were asked for
};

/// One of the paper's scenes in real time against a loop that does nothing, taken in turns.
struct LoopAccount {
  std::string scene;
  double rate_Hz = 0.0;
  std::uint64_t ticks = 0;  // of each
  std::uint64_t missed = 0;
  std::uint64_t missed_empty = 0;
  TimeFigures late;
  TimeFigures late_empty;
};

/// Moving pictures of a scene in contact, 1280 x 720 pixels.
struct PictureAccount {
  std::string scene;
  std::size_t organ_triangles = 0;  // of the organ; the picture may divide it further
  std::string driver;               // OpenGL's name of what drew them
  double fast_share = 0.0;          // of the pictures that were drawn with Quality::kFast to stay in time
  TimeFigures deformation;          // computing time of deformation and upload
  TimeFigures frame;                // wall time of a whole picture
  TimeFigures frame_computed;       // computing time of all threads for it
};

/// What another library takes for its own answer on the same organ and the same way.
struct PeerAccount {
  std::string name;
  std::string does;  // in a few words
  std::string scene;
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;  // 0: one point
  TimeFigures contact;
  TimeFigures approach;
  double ratio = 0.0;           // of p50 in contact to palpate's own
  double approach_ratio = 0.0;  // of p50 in approach
};

/// All that was measured; what was not is empty.
struct Account {
  std::string machine;
  std::string build;    // version and compiler
  std::string command;  // as typed
  double clock_ns = 0.0;
  std::vector<TickAccount> ticks;
  std::vector<NearestAccount> nearest;
  std::optional<double> law_ns;
  std::optional<double> inverse_ns;
  std::optional<double> noise_ns;
  std::vector<PreparationAccount> preparation;
  std::optional<HandsAccount> hands;
  bool polled = false;  // hands and loops, between periods; else their threads slept
  std::vector<LoopAccount> loops;
  std::vector<PictureAccount> pictures;
  std::vector<PeerAccount> peers;
  std::vector<std::string> remarks;  // what could not be measured, and why
};

/// [setup] The document of `palpate bench --json` (docs/file-formats.md), indented.
[[nodiscard]] std::string to_json(const Account& account);

/// One row of figures, of the CSV file and of the text.
struct FigureRow {
  std::string section;
  std::string name;
  std::string scene{};
  std::string phase{};
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
  TimeFigures times{};     // without samples: `value` instead
  TimeFigures least = {};  // of each time over `repeats`; without samples: not taken
  std::string note = {};   // of the text alone
  double value = 0.0;
  std::string unit = "us";
  int repeats = 0;
};

/// [setup] Every figure of an account, section by section.
[[nodiscard]] std::vector<FigureRow> rows_of(const Account& account);

/// [setup] One line a figure, with what made them as comment lines (docs/file-formats.md).
[[nodiscard]] std::string to_csv(const Account& account);

/// [setup] The same figures as tables for people.
[[nodiscard]] std::string to_text(const Account& account);

}  // namespace palpate::bench
