// Records a run, reads the recording, replays it, compares it bit for bit, and writes it as CSV.
// Usage: record_and_replay [RECORDING.h5]     (default: record_and_replay.h5 in the current folder, removed
// afterwards)
#include <filesystem>
#include <iostream>
#include <string>

#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/session.h"

namespace {

namespace fs = std::filesystem;

/// Records the built-in gallbladder press. load() takes a scene file as `.scene`.
void record_a_press(const fs::path& file) {
  auto session = palpate::session::Session::open(palpate::scene::load({}));
  const palpate::session::RunResult result = session.run({.recording = file, .offline = true});
  std::cout << result.loop.ticks << " ticks, deepest " << 1e3 * result.statistics.peak_depth << " mm\n";
}

int replay_and_compare(const fs::path& file) {
  const palpate::record::Recording recording = palpate::record::read_recording(file);
  std::cout << recording.rows.size() << " rows of \"" << recording.scene.name << "\", "
            << (recording.facts.complete ? "complete" : "cut off") << '\n';

  // The recording contains the scene and the device's samples, so a replay needs no other file.
  const palpate::record::ReplayResult result = palpate::record::replay(recording);
  std::cout << result.rows_different << " of " << result.rows_compared << " rows differ\n";
  if (!result.first_difference.empty()) std::cout << "first: " << result.first_difference << '\n';

  fs::path csv = file;
  csv.replace_extension(".csv");
  palpate::record::export_csv(recording, csv);
  std::cout << "CSV of " << fs::file_size(csv) / 1000000 << " MB\n";
  fs::remove(csv);
  return result.rows_different == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool keep = argc > 1;
  const fs::path file = keep ? argv[1] : "record_and_replay.h5";
  try {
    record_a_press(file);
    const int code = replay_and_compare(file);
    if (!keep) fs::remove(file);
    return code;
  } catch (const palpate::InputError& error) {
    std::cerr << "record_and_replay: " << error.what() << '\n';
    return 2;
  }
}
