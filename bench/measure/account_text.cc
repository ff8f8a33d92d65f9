#include <algorithm>
#include <iomanip>
#include <sstream>

#include "bench/measure/account.h"

namespace palpate::bench {
namespace {

constexpr int kNameWidth = 26;
constexpr int kCountWidth = 11;
constexpr int kFigureWidth = 10;

/// Three digits of a figure.
std::string brief(double value) {
  std::ostringstream text;
  const double size = value < 0.0 ? -value : value;
  text << std::fixed << std::setprecision(size < 10.0 ? 2 : size < 100.0 ? 1 : 0) << value;
  return text.str();
}

void begin(std::ostream& out, const std::string& name, std::size_t organ, std::size_t tool) {
  out << std::left << std::setw(kNameWidth) << name << std::right << std::setw(kCountWidth) << organ
      << std::setw(kCountWidth) << tool;
}

void figures(std::ostream& out, const TimeFigures& times) {
  for (const double value : {times.p50_us, times.p99_us, times.p999_us, times.max_us}) {
    out << std::setw(kFigureWidth) << (times.samples > 0 ? brief(value) : "-");
  }
}

void head(std::ostream& out, const std::string& title, const std::string& name, bool twice) {
  out << '\n' << title << '\n' << std::left << std::setw(kNameWidth) << name << std::right;
  out << std::setw(kCountWidth) << "organ" << std::setw(kCountWidth) << "tool";
  for (int i = 0; i < (twice ? 2 : 1); ++i) {
    for (const char* column : {"p50", "p99", "p99.9", "max"}) out << std::setw(kFigureWidth) << column;
    if (twice && i == 0) out << " |";
  }
  out << '\n';
}

void ticks(std::ostream& out, const Account& account) {
  if (account.ticks.empty()) return;
  head(out, "Whole tick, processor time in us: in contact | in approach within 20 mm", "scene", true);
  for (const TickAccount& tick : account.ticks) {
    begin(out, tick.scene, tick.organ_triangles, tick.tool_triangles);
    figures(out, tick.contact);
    out << " |";
    figures(out, tick.approach);
    out << '\n';
  }
}

/// What a tick costs by itself, and what the machine adds.
void least_ticks(std::ostream& out, const Account& account) {
  if (account.ticks.empty() || account.ticks.front().plain.samples == 0) return;
  head(out,
       "By themselves: each tick's least of " + std::to_string(account.ticks.front().repeats) +
           " repeats, us: in contact | in approach",
       "scene", true);
  for (const TickAccount& tick : account.ticks) {
    begin(out, tick.scene, tick.organ_triangles, tick.tool_triangles);
    figures(out, tick.contact_least);
    out << " |";
    figures(out, tick.approach_least);
    out << '\n';
  }
  head(out, "Plain arithmetic as long as a tick in contact, us: every single time | the least", "beside",
       true);
  for (const TickAccount& tick : account.ticks) {
    begin(out, tick.scene, tick.organ_triangles, tick.tool_triangles);
    figures(out, tick.plain);
    out << " |";
    figures(out, tick.plain_least);
    out << '\n';
  }
}

void nearest(std::ostream& out, const Account& account) {
  if (account.nearest.empty()) return;
  head(out, "One exact nearest point, processor time in us (mean of 16)", "", false);
  for (const NearestAccount& one : account.nearest) {
    begin(out, "palpate", one.organ_triangles, 1);
    figures(out, one.times);
    out << '\n';
  }
}

void peers(std::ostream& out, const Account& account) {
  if (account.peers.empty()) return;
  head(out, "Peers, same organ, way and clock, processor time in us: in contact | in approach", "", true);
  for (const PeerAccount& peer : account.peers) {
    begin(out, peer.name, peer.organ_triangles, peer.tool_triangles);
    figures(out, peer.contact);
    out << " |";
    figures(out, peer.approach);
    out << "   " << brief(peer.ratio) << " | " << brief(peer.approach_ratio) << " times palpate's p50\n";
  }
}

void parts(std::ostream& out, const Account& account) {
  if (!account.law_ns || !account.inverse_ns || !account.noise_ns) return;
  out << "\nForce at a depth:         " << brief(*account.law_ns) << " ns\n"
      << "Depth under a force:      " << brief(*account.inverse_ns) << " ns\n"
      << "Noise sample by number:   " << brief(*account.noise_ns) << " ns\n";
}

void preparation(std::ostream& out, const Account& account) {
  if (account.preparation.empty()) return;
  out << "\nPreparation of the organ (wall time)\n";
  for (const PreparationAccount& one : account.preparation) {
    constexpr double kMegabyte = 1e6;
    const double bytes = static_cast<double>(one.bytes);
    out << std::left << std::setw(kNameWidth) << one.organ << std::right << std::setw(kCountWidth)
        << one.organ_triangles << std::setw(kFigureWidth) << brief(one.seconds) << " s"
        << std::setw(kFigureWidth) << brief(bytes / kMegabyte) << " MB" << std::setw(kFigureWidth)
        << brief(bytes / static_cast<double>(std::max<std::size_t>(1, one.organ_triangles)))
        << " bytes a triangle\n";
  }
}

void hands_run(std::ostream& out, const HandsRun& run) {
  if (run.hands == 0) return;
  out << run.hands << " hands on " << run.threads << (run.threads == 1 ? " thread" : " threads")
      << ": a period's work p50 " << brief(run.round.p50_us) << ", p99.9 " << brief(run.round.p999_us)
      << " (worst core " << brief(run.worst_p999_us) << "), max " << brief(run.round.max_us)
      << " us; by the wall clock " << brief(run.wall.p50_us) << ", " << brief(run.wall.p999_us) << ", "
      << brief(run.wall.max_us) << "; " << run.missed << " of " << run.periods << " periods missed\n";
  if (run.lost > 0) out << "  " << run.lost << " rows were lost: what takes them could not keep up\n";
}

/// How threads waited for their periods.
const char* between(const Account& account) {
  return account.polled ? ", polling the clock between periods" : "";
}

void hands(std::ostream& out, const Account& bench) {
  const HandsAccount& account = *bench.hands;
  constexpr double kKilobyte = 1e3;
  out << "\nHands at 1 kHz, all in contact, that fit each core inside 80 % of the period at p99.9"
      << between(bench) << ": " << account.hands_per_core
      << "\nMemory a hand beyond the organ: " << brief(account.bytes_per_hand / kKilobyte) << " kB\n";
  hands_run(out, account.most);
  hands_run(out, account.asked);
}

void loops(std::ostream& out, const Account& account) {
  for (const LoopAccount& loop : account.loops) {
    out << '\n'
        << loop.scene << " at " << brief(loop.rate_Hz) << " Hz" << between(account) << ": " << loop.missed
        << " of " << loop.ticks << " deadlines missed, late p50 " << brief(loop.late.p50_us) << ", p99.9 "
        << brief(loop.late.p999_us) << ", max " << brief(loop.late.max_us)
        << " us\n  an empty loop in turns with it: " << loop.missed_empty << " missed, late p50 "
        << brief(loop.late_empty.p50_us) << ", p99.9 " << brief(loop.late_empty.p999_us) << ", max "
        << brief(loop.late_empty.max_us) << " us\n";
  }
}

void pictures(std::ostream& out, const Account& account) {
  constexpr double kPercent = 100.0;
  if (account.pictures.empty()) return;
  out << "\nMoving pictures in contact, 1280 x 720, by " << account.pictures.front().driver << " [ms]\n";
  for (const PictureAccount& picture : account.pictures) {
    out << "  " << picture.scene << ", " << picture.organ_triangles
        << " triangles: deformation and upload p50 " << brief(picture.deformation.p50_us * 1e-3) << ", p99 "
        << brief(picture.deformation.p99_us * 1e-3) << "; whole picture p50 "
        << brief(picture.frame.p50_us * 1e-3) << ", p99 " << brief(picture.frame.p99_us * 1e-3)
        << " (computing, all threads: " << brief(picture.frame_computed.p50_us * 1e-3) << "); "
        << brief(kPercent * picture.fast_share) << " % drawn fast\n";
  }
}

}  // namespace

std::string to_text(const Account& account) {
  std::ostringstream out;
  out << account.machine << "\n"
      << account.build << "; reading the clock takes " << brief(account.clock_ns) << " ns of every time\n";
  ticks(out, account);
  least_ticks(out, account);
  nearest(out, account);
  peers(out, account);
  parts(out, account);
  preparation(out, account);
  if (account.hands) hands(out, account);
  loops(out, account);
  pictures(out, account);
  for (const std::string& remark : account.remarks) out << "\n" << remark << '\n';
  return out.str();
}

}  // namespace palpate::bench
