#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/times.h"

namespace palpate::bench {

/// Receives the completed fraction (0..1) and what is being measured.
using Watch = std::function<void(double share, const std::string& what)>;

/// Time of whole ticks: device sample, force and torque after the gate, the row into the recorder's ring.
struct TickAccount {
  std::string scene;
  std::string phase;  // press
                      // pull
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
  TimeStatistics contact;
  TimeStatistics approach;  // within 20 mm
  // The path is followed `repeats` times, and every tick is identical each time. The least time of a tick is
  // its own cost; the excess of single times comes from the machine: interrupts, and caches and tables to
  // fill again afterwards.
  int repeats = 0;
  TimeStatistics contact_least;
  TimeStatistics approach_least;
  TimeStatistics first;  // the first tick of each repeat; it counts above too
};

/// Time of one exact nearest-point query of the organ, along the path of the tool's tip.
struct NearestAccount {
  std::size_t organ_triangles = 0;
  TimeStatistics times;
};

/// Cost of preparing an organ before its first tick: refined surface, normals, tree.
struct PreparationAccount {
  std::string organ;
  std::size_t organ_triangles = 0;
  double seconds = 0.0;   // wall time
  std::size_t bytes = 0;  // memory kept
};

/// Independent hands on one organ at 1 kHz, one thread per core, all at once.
struct HandsRun {
  std::size_t hands = 0;  // on all threads; 0: not run
  std::size_t threads = 0;
  std::uint64_t periods = 0;   // on all threads
  std::uint64_t missed = 0;    // periods that began a full period late
  std::uint64_t lost = 0;      // rows lost because the ring was full
  TimeStatistics round;        // CPU time of all hands of one thread in one period
  TimeStatistics wall;         // wall time of the work in a period
  double worst_p999_us = 0.0;  // p99.9 of `round`, on the thread where it is greatest
};

/// Capacity for hands in one process.
struct HandsAccount {
  std::size_t hands_per_core = 0;  // within 80 % of the period at p99.9 on every core
  double bytes_per_hand = 0.0;     // in addition to the shared organ
  HandsRun most;                   // with `hands_per_core` hands on each core
  HandsRun asked;                  // with the requested number of hands
};

/// One of the paper's scenes in real time compared with an empty loop, in turns.
struct LoopAccount {
  std::string scene;
  double rate_Hz = 0.0;
  std::uint64_t ticks = 0;  // of each loop
  std::uint64_t missed = 0;
  std::uint64_t missed_empty = 0;
  TimeStatistics late;
  TimeStatistics late_empty;
};

/// Rendering of a moving scene in contact, 1280 x 720 pixels.
struct PictureAccount {
  std::string scene;
  std::size_t organ_triangles = 0;  // of the organ's mesh; the renderer may subdivide it
  std::string driver;               // OpenGL's name of the renderer
  std::string quality;              // balanced or fast
  TimeStatistics deformation;       // CPU time of deformation and upload
  TimeStatistics frame;             // wall time of a picture
  TimeStatistics frame_computed;    // CPU time of all threads for a picture
  TimeStatistics redraw_computed;   // CPU time of all threads where all of each picture is drawn
  TimeStatistics turned_computed;   // CPU time of all threads while the view turns
  TimeStatistics drape_computed;    // the same with a drape under the organ
};

/// Time that another library needs for its own answer on the same organ and path.
struct PeerAccount {
  std::string name;
  std::string does;  // what it computes, in a few words
  std::string scene;
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;  // 0: one point
  TimeStatistics contact;
  TimeStatistics approach;
  double ratio = 0.0;           // p50 in contact relative to Palpate's
  double approach_ratio = 0.0;  // p50 in approach relative to Palpate's
};

/// All measurements; those not made are empty.
struct Account {
  std::string machine;
  std::string build;    // version and compiler
  std::string command;  // command line
  double clock_ns = 0.0;
  std::vector<TickAccount> ticks;
  std::vector<NearestAccount> nearest;
  std::optional<double> law_ns;
  std::optional<double> inverse_ns;
  std::optional<double> noise_ns;
  std::vector<PreparationAccount> preparation;
  std::optional<HandsAccount> hands;
  bool polled = false;  // hands and loops poll between periods; false: their threads sleep
  std::vector<LoopAccount> loops;
  std::vector<PictureAccount> pictures;
  std::vector<PeerAccount> peers;
  std::vector<std::string> remarks;  // measurements that were not possible, with the reason
};

/// [setup] The JSON document of `palpate bench --json` (docs/file-formats.md), indented.
[[nodiscard]] std::string to_json(const Account& account);

/// One row of the CSV file and of the text.
struct FigureRow {
  std::string section;
  std::string name;
  std::string scene{};
  std::string phase{};
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
  TimeStatistics times{};     // without samples: `value` is used instead
  TimeStatistics least = {};  // least time of each tick over `repeats`; without samples: not measured
  std::string note = {};      // only in the text
  double value = 0.0;
  std::string unit = "us";
  int repeats = 0;
};

/// [setup] All rows of an account, by section.
[[nodiscard]] std::vector<FigureRow> rows_of(const Account& account);

/// [setup] CSV with one line per row; comment lines describe machine, build and command
/// (docs/file-formats.md).
[[nodiscard]] std::string to_csv(const Account& account);

/// [setup] The same rows as tables of text.
[[nodiscard]] std::string to_text(const Account& account);

}  // namespace palpate::bench
