#include <initializer_list>

#include "core/base/text.h"

#include "bench/measure/account.h"

namespace palpate::bench {
namespace {

/// A cell: in quotes where a comma or a quote needs it.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter == '\n' ? ' ' : letter;
  }
  return quoted + '"';
}

/// A comment stays one line.
std::string one_line(std::string text) {
  for (char& letter : text) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  return text;
}

/// What a figure is of.
struct Of {
  std::string section;
  std::string name;
  std::string scene;
  std::string phase;
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
};

class Table final {
 public:
  explicit Table(std::string head) : text_(std::move(head)) {
    text_ += "section,name,scene,phase,organ_triangles,tool_triangles,samples,p50_us,p99_us,p999_us,max_us,";
    text_ += "value,unit,repeats,least_p50_us,least_p99_us,least_p999_us,least_max_us\n";
  }

  void add(const Of& of, const TimeFigures& figures) {
    begin(of);
    text_ += std::to_string(figures.samples);
    add_times(figures);
    text_ += ",,us,,,,,\n";
  }

  /// @param least of each time's least over `repeats`
  void add(const Of& of, const TimeFigures& figures, int repeats, const TimeFigures& least) {
    begin(of);
    text_ += std::to_string(figures.samples);
    add_times(figures);
    text_ += ",,us," + std::to_string(repeats);
    add_times(least);
    text_ += "\n";
  }

  void add(const Of& of, double value, const std::string& unit) {
    begin(of);
    text_ += ",,,,," + shortest(value) + "," + unit + ",,,,,\n";
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void begin(const Of& of) {
    for (const std::string& word : {of.section, of.name, of.scene, of.phase}) text_ += cell(word) + ",";
    text_ += std::to_string(of.organ_triangles) + "," + std::to_string(of.tool_triangles) + ",";
  }

  void add_times(const TimeFigures& figures) {
    for (const double value : {figures.p50_us, figures.p99_us, figures.p999_us, figures.max_us})
      text_ += "," + shortest(value);
  }

  std::string text_;
};

void add_ticks(Table& table, const Account& account) {
  for (const TickAccount& tick : account.ticks) {
    Of of{"tick", "palpate", tick.scene, "contact", tick.organ_triangles, tick.tool_triangles};
    table.add(of, tick.contact, tick.repeats, tick.contact_least);
    of.phase = "approach";
    table.add(of, tick.approach, tick.repeats, tick.approach_least);
    if (tick.plain.samples == 0) continue;
    of.section = "machine";
    of.name = "plain arithmetic";
    of.phase = "contact";
    table.add(of, tick.plain, tick.repeats - 1, tick.plain_least);
  }
  for (const NearestAccount& one : account.nearest)
    table.add({"nearest", "palpate", "", "", one.organ_triangles, 0}, one.times);
}

void add_parts(Table& table, const Account& account) {
  if (account.law_ns) table.add({"part", "force at a depth", "", "", 0, 0}, *account.law_ns, "ns");
  if (account.inverse_ns) table.add({"part", "depth under a force", "", "", 0, 0}, *account.inverse_ns, "ns");
  if (account.noise_ns) table.add({"part", "noise sample by number", "", "", 0, 0}, *account.noise_ns, "ns");
}

void add_preparation(Table& table, const Account& account) {
  for (const PreparationAccount& one : account.preparation) {
    const Of of{"preparation", one.organ, "", "", one.organ_triangles, 0};
    table.add(of, one.seconds, "s");
    table.add(of, static_cast<double>(one.bytes), "B");
  }
}

void add_hands_run(Table& table, const HandsRun& run) {
  if (run.hands == 0) return;
  const std::string name = std::to_string(run.hands) + " hands on " + std::to_string(run.threads) +
                           (run.threads == 1 ? " thread" : " threads");
  table.add({"hands", name, "", "", 0, 0}, run.round);
  table.add({"hands", name + ", wall clock", "", "", 0, 0}, run.wall);
  table.add({"hands", name + ", missed periods", "", "", 0, 0}, static_cast<double>(run.missed), "1");
}

void add_hands(Table& table, const HandsAccount& hands) {
  table.add({"hands", "hands a core", "", "", 0, 0}, static_cast<double>(hands.hands_per_core), "1");
  table.add({"hands", "memory a hand", "", "", 0, 0}, hands.bytes_per_hand, "B");
  add_hands_run(table, hands.most);
  add_hands_run(table, hands.asked);
}

void add_loops(Table& table, const Account& account) {
  for (const LoopAccount& loop : account.loops) {
    const std::string rate = shortest(loop.rate_Hz) + " Hz";
    table.add({"loop", rate, loop.scene, "late", 0, 0}, loop.late);
    table.add({"loop", rate, loop.scene, "late, empty", 0, 0}, loop.late_empty);
    table.add({"loop", rate, loop.scene, "missed", 0, 0}, static_cast<double>(loop.missed), "1");
    table.add({"loop", rate, loop.scene, "missed, empty", 0, 0}, static_cast<double>(loop.missed_empty), "1");
  }
}

void add_pictures(Table& table, const Account& account) {
  for (const PictureAccount& picture : account.pictures) {
    Of of{"picture", "deformation and upload", picture.scene, "contact", picture.organ_triangles, 0};
    table.add(of, picture.deformation);
    of.name = "whole picture";
    table.add(of, picture.frame);
    of.name = "whole picture, all threads";
    table.add(of, picture.frame_computed);
  }
}

void add_peers(Table& table, const Account& account) {
  for (const PeerAccount& peer : account.peers) {
    Of of{"peer", peer.name, peer.scene, "contact", peer.organ_triangles, peer.tool_triangles};
    if (peer.contact.samples > 0) table.add(of, peer.contact);
    of.phase = "approach";
    if (peer.approach.samples > 0) table.add(of, peer.approach);
  }
}

}  // namespace

std::string to_csv(const Account& account) {
  std::string head = "# machine: " + one_line(account.machine) + "\n# build: " + one_line(account.build) +
                     "\n# command: " + one_line(account.command) +
                     "\n# clock_ns: " + shortest(account.clock_ns) + " (in every single time)\n";
  for (const std::string& remark : account.remarks) head += "# remark: " + one_line(remark) + "\n";
  Table table(std::move(head));
  add_ticks(table, account);
  add_parts(table, account);
  add_preparation(table, account);
  if (account.hands) add_hands(table, *account.hands);
  add_loops(table, account);
  add_pictures(table, account);
  add_peers(table, account);
  return table.text();
}

}  // namespace palpate::bench
