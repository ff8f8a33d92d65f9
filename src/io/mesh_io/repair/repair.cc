#include "io/mesh_io/repair/repair.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/repair/repair_components.h"
#include "io/mesh_io/repair/repair_holes.h"
#include "io/mesh_io/repair/repair_slivers.h"
#include "io/mesh_io/repair/repair_surface.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::mesh_io {
namespace {

constexpr double kWeld =
    1e-6;  // of the bounding box's diagonal: the rounding of 32-bit coordinates, and text

// A hole is small when it has at most kMaxHoleEdges edges and spans at most kMaxHoleWidth of the bounding
// box's diagonal, or when one or two triangles are missing (kFewHoleEdges) of at most kFewHoleArea of the
// surface's area.
constexpr std::size_t kMaxHoleEdges = 200;
constexpr double kMaxHoleWidth = 0.2;
constexpr std::size_t kFewHoleEdges = 4;
constexpr double kFewHoleArea = 0.1;
constexpr std::uint64_t kMaxHoleSteps = 60'000'000;  // about 2 s

std::string triangles(std::size_t count) { return counted(count, "triangle", "triangles"); }

/// In millimetres, with three significant digits.
std::string millimetres(double metres) {
  return shortest(parse_number(brief(metres / kMillimetre, 3)).value_or(0.0));
}

std::string position_text(const Vec3& p) {
  return fmt::format("({}, {}, {}) mm", millimetres(p.x()), millimetres(p.y()), millimetres(p.z()));
}

std::string percent(double share) {
  const double value = 100.0 * share;
  return value < 0.01 ? "under 0.01 %" : shortest(std::round(value * 100.0) / 100.0) + " %";
}

class Repair final {
 public:
  Repair(geometry::TriangleMesh mesh, bool is_sound) : surface_(std::move(mesh)), is_sound_(is_sound) {}

  RepairedSurface run() {
    if (!is_sound_) drop_and_weld();
    if (!is_sound_ && repaired_.refusal.empty()) split_and_orient();
    if (!is_sound_ && repaired_.refusal.empty()) close_holes();
    if (repaired_.refusal.empty()) finish();
    repaired_.mesh = std::move(surface_.mesh);
    return std::move(repaired_);
  }

 private:
  void report(const std::string& message) { repaired_.repairs.push_back(message); }
  /// Reports a repair, such as "dropped 2 small components (6 triangles)", if there was any.
  void report(const RepairCount& done, std::string_view one, std::string_view more,
              std::string_view measure = "", std::string_view why = "") {
    if (done.times == 0) return;
    report(fmt::format("dropped {} ({}{}){}", counted(done.times, one, more), triangles(done.triangles),
                       measure, why));
  }
  void refuse(const std::string& message) { repaired_.refusal = message; }

  void drop_and_weld() {
    if (const std::size_t count = drop_collapsed(surface_); count > 0) {
      report(
          fmt::format("dropped {} that {} a vertex twice", triangles(count), count == 1 ? "names" : "name"));
    }
    std::size_t duplicates = drop_duplicates(surface_);
    const double tolerance = kWeld * geometry::bounds(surface_.mesh).size().norm();
    if (const std::size_t count = weld_boundaries(surface_, tolerance); count > 0) {
      report(fmt::format("joined {} at boundaries less than {} mm apart",
                         counted(count, "vertex", "vertices"), millimetres(tolerance)));
      duplicates += drop_duplicates(surface_);
    }
    if (duplicates > 0) report("dropped " + counted(duplicates, "duplicate triangle", "duplicate triangles"));
    report(drop_dangling_faces(surface_), "patch of dangling faces", "patches of dangling faces");
    report(drop_internal_faces(surface_), "patch of internal faces", "patches of internal faces");
    if (surface_.mesh.triangles.empty()) refuse("no triangles are left");
  }

  void split_and_orient() {
    refuse_non_manifold(/*odd_only=*/true);
    if (!repaired_.refusal.empty()) return;
    Opposites opposite = pair_half_edges(surface_);
    std::size_t added = split_bow_tie_vertices(surface_, opposite);
    constexpr int kMaxRounds = 4;  // a triangle may have three such edges
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::size_t middles = split_non_manifold_edges(surface_, opposite);
      if (middles == 0) break;
      opposite = pair_half_edges(surface_);
      added += middles + split_bow_tie_vertices(surface_, opposite);
    }
    if (added > 0) {
      report("separated touching surfaces with " + counted(added, "new vertex", "new vertices"));
    }
    if (!orient_consistently(surface_, opposite)) {
      return refuse("its surface has only one side, so it has no outside");
    }
    report(drop_small_open_components(surface_, opposite), "small open component", "small open components");
    refuse_non_manifold(/*odd_only=*/false);
  }

  /// Rejects non-manifold edges, with odd_only only those with an odd number of triangles, which cannot be
  /// paired.
  void refuse_non_manifold(bool odd_only) {
    std::size_t count = 0;
    Vec3 at = Vec3::Zero();
    for_each_edge(
        sorted_half_edges(surface_.mesh.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
          if (last - first <= 2 || (odd_only && (last - first) % 2 == 0)) return;
          if (count++ > 0) return;
          at = 0.5 * (surface_.point_at(first->corner) + surface_.point_at(next_corner(first->corner)));
        });
    if (count == 0) return;
    refuse(fmt::format("{} of more than two triangles (the first at {}) that are no dangling faces",
                       counted(count, "edge", "edges"), position_text(at)));
  }

  void close_holes() {
    const std::vector<Hole> holes = holes_of(surface_, pair_half_edges(surface_));
    if (holes.empty()) return;
    const double diagonal = geometry::bounds(surface_.mesh).size().norm();
    const double area = surface_.area();
    std::uint64_t steps = 0;
    for (const Hole& hole : holes) {
      const std::uint64_t n = hole.loop.size();
      if (n <= kMaxHoleEdges) steps += n * n * n / 6 + 1;
    }
    if (steps > kMaxHoleSteps) {
      return refuse(counted(holes.size(), "hole", "holes") + ": too many to be damage");
    }
    const std::vector<std::uint64_t> edges = edges_of(surface_);
    std::vector<const Hole*> large;
    std::size_t added = 0;
    double widest = 0.0;
    for (const Hole& hole : holes) {
      const bool is_narrow = hole.loop.size() <= kMaxHoleEdges && hole.width <= kMaxHoleWidth * diagonal;
      HolePatch patch;
      if (is_narrow || hole.loop.size() <= kFewHoleEdges) patch = patch_of(surface_, edges, hole);
      if (patch.triangles.empty() || (patch.area > kFewHoleArea * area && !is_narrow)) {
        large.push_back(&hole);
        continue;
      }
      if (patch.middle) surface_.mesh.vertices.push_back(*patch.middle);
      for (const geometry::Triangle& triangle : patch.triangles) surface_.add(triangle, kAdded);
      added += patch.triangles.size();
      widest = std::max(widest, hole.width);
    }
    if (const std::size_t closed = holes.size() - large.size(); closed > 0) {
      report(fmt::format("closed {} with {}{}{} mm across)", counted(closed, "hole", "holes"),
                         triangles(added), closed == 1 ? " (" : " (the widest ", millimetres(widest)));
    }
    if (!large.empty()) refuse_holes(large, diagonal);
  }

  void refuse_holes(const std::vector<const Hole*>& holes, double diagonal) {
    const Hole& widest = **std::max_element(holes.begin(), holes.end(),
                                            [](const Hole* a, const Hole* b) { return a->width < b->width; });
    refuse(fmt::format(
        "{} of {} edges, {} mm across, at {} (closed are those of up to {} edges and {} mm, a fifth of its "
        "diagonal)",
        holes.size() == 1 ? "a hole" : std::to_string(holes.size()) + " holes, the largest",
        widest.loop.size(), millimetres(widest.width), position_text(widest.middle), kMaxHoleEdges,
        millimetres(kMaxHoleWidth * diagonal)));
  }

  void finish() {
    if (const std::size_t count = remove_slivers(surface_); count > 0) {
      report("removed " + triangles(count) + " without area");
    }
    const ComponentRepairs components = clean_components(surface_, is_sound_);
    const auto turned = static_cast<std::size_t>(
        std::count_if(surface_.marks.begin(), surface_.marks.end(),
                      [](std::uint8_t mark) { return (mark & (kReversed | kAdded)) == kReversed; }));
    if (turned > 0) {
      report(fmt::format("turned {}{} outwards", turned == surface_.marks.size() ? "all " : std::string(),
                         triangles(turned)));
    }
    report(components.small, "small component", "small components",
           ", " + percent(components.small_share) + " of the volume");
    report(components.inner, "inner shell", "inner shells", "", ": an organ is solid");
    if (!components.refusal.empty()) {
      if (!components.remedy.empty()) repaired_.remedy = components.remedy;
      return refuse(components.refusal);
    }
    repaired_.crossing_pairs = components.crossing_pairs;
    if (components.crossing_pairs > 0) {
      repaired_.remarks.push_back(fmt::format(
          "{} of triangles that go through each other ({} of the surface)",
          counted(components.crossing_pairs, "pair", "pairs"), percent(components.crossing_share)));
    }
    if (components.kept > 1)
      repaired_.remarks.push_back(std::to_string(components.kept) + " separate components");
  }

  WorkSurface surface_;
  bool is_sound_;
  RepairedSurface repaired_;
};

}  // namespace

RepairedSurface repair_surface(geometry::TriangleMesh mesh, bool is_sound) {
  return Repair(std::move(mesh), is_sound).run();
}

LoadedMesh repair_organ(LoadedMesh loaded, const std::string& name) {
  // Two triangles alone may be one triangle from both sides.
  const bool is_sound = loaded.findings.defects.empty() && loaded.findings.remarks.empty() &&
                        loaded.findings.shells == 1 && loaded.mesh.triangles.size() > 2;
  RepairedSurface repaired = repair_surface(std::move(loaded.mesh), is_sound);
  if (!repaired.refusal.empty()) {
    throw InputError(name + ": cannot be an organ: " + repaired.refusal + ": " + repaired.remedy);
  }
  LoadedMesh organ{std::move(repaired.mesh), {}, std::move(loaded.space)};
  organ.findings =
      is_sound && repaired.repairs.empty() ? std::move(loaded.findings) : findings_of(organ.mesh);
  organ.findings.crossing_pairs = repaired.crossing_pairs;
  const auto append = [](std::vector<std::string>& all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  append(organ.findings.repairs, loaded.findings.repairs);
  append(organ.findings.repairs, repaired.repairs);
  append(organ.findings.remarks, repaired.remarks);
  require_organ(organ, name);
  return organ;
}

}  // namespace palpate::mesh_io
