// The rows of an account, as CSV and as tables of text.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/text.h"

#include "bench/measure/account.h"

namespace palpate::bench {
namespace {

using Rows = std::vector<FigureRow>;

void add_value(Rows& rows, FigureRow what, double value, const std::string& unit) {
  what.value = value;
  what.unit = unit;
  rows.push_back(std::move(what));
}

void add_ticks(Rows& rows, const TickAccount& tick) {
  FigureRow row{
      "tick",       "palpate",         tick.scene, "contact", tick.organ_triangles, tick.tool_triangles,
      tick.contact, tick.contact_least};
  row.repeats = tick.repeats;
  rows.push_back(row);
  row.phase = "approach";
  row.times = tick.approach;
  row.least = tick.approach_least;
  rows.push_back(row);
  if (tick.first.samples == 0) return;
  row.phase = "first tick";
  row.times = tick.first;
  row.least = {};
  rows.push_back(row);
}

void add_parts(Rows& rows, const Account& account) {
  if (account.law_ns) add_value(rows, {"part", "force at a depth"}, *account.law_ns, "ns");
  if (account.inverse_ns) add_value(rows, {"part", "depth under a force"}, *account.inverse_ns, "ns");
  if (account.noise_ns) add_value(rows, {"part", "noise sample by number"}, *account.noise_ns, "ns");
}

void add_hands_run(Rows& rows, const HandsRun& run) {
  if (run.hands == 0) return;
  const std::string name =
      fmt::format("{} hands on {} thread{}", run.hands, run.threads, run.threads == 1 ? "" : "s");
  rows.push_back({"hands", name, "", "", 0, 0, run.round});
  rows.push_back({"hands", name + ", wall clock", "", "", 0, 0, run.wall});
  add_value(rows, {"hands", name + ", p99.9 of the worst core"}, run.worst_p999_us, "us");
  add_value(rows, {"hands", name + ", missed periods"}, static_cast<double>(run.missed), "1");
  add_value(rows, {"hands", name + ", lost rows"}, static_cast<double>(run.lost), "1");
}

void add_loop(Rows& rows, const LoopAccount& loop) {
  const std::string rate = shortest(loop.rate_Hz) + " Hz";
  rows.push_back({"loop", rate, loop.scene, "late", 0, 0, loop.late});
  rows.push_back({"loop", rate, loop.scene, "late, empty", 0, 0, loop.late_empty});
  add_value(rows, {"loop", rate, loop.scene, "missed"}, static_cast<double>(loop.missed), "1");
  add_value(rows, {"loop", rate, loop.scene, "missed, empty"}, static_cast<double>(loop.missed_empty), "1");
}

void add_picture(Rows& rows, const PictureAccount& picture) {
  const auto add = [&](const std::string& name, const TimeStatistics& times) {
    rows.push_back({"picture", name + (", " + picture.quality), picture.scene, "contact",
                    picture.organ_triangles, 0, times});
  };
  add("deformation and upload", picture.deformation);
  add("whole picture", picture.frame);
  rows.back().note = "by " + picture.driver;
  add("whole picture, all threads", picture.frame_computed);
  add("full redraw, all threads", picture.redraw_computed);
  add("turning view, all threads", picture.turned_computed);
  add("turning view with a drape, all threads", picture.drape_computed);
}

void add_peer(Rows& rows, const PeerAccount& peer) {
  const auto add = [&](const char* phase, const TimeStatistics& times, double ratio) {
    if (times.samples == 0) return;
    rows.push_back({"peer", peer.name, peer.scene, phase, peer.organ_triangles, peer.tool_triangles, times});
    rows.back().note = fmt::format("{:.3g} times palpate's p50", ratio);
  };
  add("contact", peer.contact, peer.ratio);
  add("approach", peer.approach, peer.approach_ratio);
}

/// Replaces line ends, because a comment is one line.
std::string one_line(std::string text) {
  for (char& letter : text) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  return text;
}

/// A CSV cell, quoted where it contains a comma or a quote.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : one_line(text)) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

/// Four cells; empty ones without samples.
std::string time_cells(const TimeStatistics& times) {
  if (times.samples == 0) return ",,,";
  return fmt::format("{},{},{},{}", shortest(times.p50_us), shortest(times.p99_us), shortest(times.p999_us),
                     shortest(times.max_us));
}

/// Three digits.
std::string brief(double value) {
  const double size = value < 0.0 ? -value : value;
  return fmt::format("{:.{}f}", value, size < 10.0 ? 2 : size < 100.0 ? 1 : 0);
}

std::string time_columns(const TimeStatistics& times) {
  return fmt::format("{:>10}{:>10}{:>10}{:>10}", brief(times.p50_us), brief(times.p99_us),
                     brief(times.p999_us), brief(times.max_us));
}

std::string title_of(const Account& account, const std::string& section) {
  const std::string polled = account.polled ? ", polling the clock between periods" : "";
  const std::map<std::string, std::string> titles = {
      {"tick", "Whole tick, processor time, all times | each tick's least of the repeats"},
      {"nearest", "One exact nearest point, processor time (mean of 16)"},
      {"part", "Parts of a tick, processor time"},
      {"preparation", "Preparation of the organ, wall time and memory"},
      {"hands", "Hands at 1 kHz, all in contact, inside 80 % of the period at p99.9" + polled},
      {"loop", "A loop in real time and an empty one in turns with it, by the wall clock" + polled},
      {"picture", "Moving pictures in contact, 1280 x 720"},
      {"peer", "Peers, same organ, path and clock, processor time"}};
  return fmt::format("\n{}\n{:<54}{:>9}{:>9}{:>10}{:>10}{:>10}{:>10} [us]\n", titles.at(section), "", "organ",
                     "tool", "p50", "p99", "p99.9", "max");
}

std::string text_of(const FigureRow& row) {
  std::string name = row.name;
  for (const std::string& word : {row.scene, row.phase}) name += word.empty() ? "" : ", " + word;
  const auto count = [](std::size_t triangles) { return triangles > 0 ? std::to_string(triangles) : ""; };
  std::string text =
      fmt::format("{:<54}{:>9}{:>9}", name, count(row.organ_triangles), count(row.tool_triangles));
  if (row.times.samples > 0) {
    text += time_columns(row.times);
  } else if (row.unit == "B") {
    text += fmt::format("{:>10} kB", brief(1e-3 * row.value));
  } else {
    text += fmt::format("{:>10} {}", brief(row.value), row.unit == "1" ? "" : row.unit);
  }
  if (row.least.samples > 0) text += " |" + time_columns(row.least) + fmt::format(" of {}", row.repeats);
  if (!row.note.empty()) text += "  " + row.note;
  return text + '\n';
}

}  // namespace

std::vector<FigureRow> rows_of(const Account& account) {
  Rows rows;
  for (const TickAccount& tick : account.ticks) add_ticks(rows, tick);
  for (const NearestAccount& one : account.nearest)
    rows.push_back({"nearest", "palpate", "", "", one.organ_triangles, 0, one.times});
  add_parts(rows, account);
  for (const PreparationAccount& one : account.preparation) {
    const FigureRow what{"preparation", one.organ, "", "", one.organ_triangles};
    add_value(rows, what, one.seconds, "s");
    add_value(rows, what, static_cast<double>(one.bytes), "B");
  }
  if (account.hands) {
    add_value(rows, {"hands", "hands a core"}, static_cast<double>(account.hands->hands_per_core), "1");
    add_value(rows, {"hands", "memory a hand"}, account.hands->bytes_per_hand, "B");
    add_hands_run(rows, account.hands->most);
    add_hands_run(rows, account.hands->asked);
  }
  for (const LoopAccount& loop : account.loops) add_loop(rows, loop);
  for (const PictureAccount& picture : account.pictures) add_picture(rows, picture);
  for (const PeerAccount& peer : account.peers) add_peer(rows, peer);
  return rows;
}

std::string to_csv(const Account& account) {
  std::string csv =
      fmt::format("# machine: {}\n# build: {}\n# command: {}\n# clock_ns: {} (in every single time)\n",
                  one_line(account.machine), one_line(account.build), one_line(account.command),
                  shortest(account.clock_ns));
  for (const std::string& remark : account.remarks) csv += "# remark: " + one_line(remark) + "\n";
  csv += "section,name,scene,phase,organ_triangles,tool_triangles,samples,p50_us,p99_us,p999_us,max_us,";
  csv += "value,unit,repeats,least_p50_us,least_p99_us,least_p999_us,least_max_us\n";
  for (const FigureRow& row : rows_of(account)) {
    const bool timed = row.times.samples > 0;
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", cell(row.section), cell(row.name),
                       cell(row.scene), cell(row.phase), row.organ_triangles, row.tool_triangles,
                       timed ? std::to_string(row.times.samples) : "", time_cells(row.times),
                       timed ? "" : shortest(row.value), row.unit,
                       row.least.samples > 0 ? std::to_string(row.repeats) : "", time_cells(row.least));
  }
  return csv;
}

std::string to_text(const Account& account) {
  std::string text = fmt::format("{}\n{}; reading the clock takes {} ns of every time\n", account.machine,
                                 account.build, brief(account.clock_ns));
  std::string section;
  for (const FigureRow& row : rows_of(account)) {
    if (row.section != section) text += title_of(account, row.section);
    section = row.section;
    text += text_of(row);
  }
  for (const std::string& remark : account.remarks) text += "\n" + remark + '\n';
  return text;
}

}  // namespace palpate::bench
