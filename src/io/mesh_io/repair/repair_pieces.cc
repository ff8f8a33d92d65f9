#include "io/mesh_io/repair/repair_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "io/mesh_io/repair/crossings.h"

namespace palpate::geometry {
namespace {

constexpr double kScrap = 0.01;          // of the largest piece's volume, or of the surface when open
constexpr std::size_t kMostPieces = 32;  // that are no scraps
constexpr double kMostCrossing = 0.05;   // of the surface
constexpr double kNoVolume = 1e-9;       // of the surface to the power of 3/2

struct Piece {
  double volume = 0.0;
  double area = 0.0;
  std::size_t triangles = 0;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());
  [[nodiscard]] bool holds(const Piece& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

/// The pieces by their smallest triangle; what no piece is named by stays empty.
std::vector<Piece> measured(const WorkSurface& surface, const std::vector<std::uint32_t>& piece_of) {
  std::vector<Piece> pieces(piece_of.size());
  for (std::uint32_t t = 0; t < piece_of.size(); ++t) {
    Piece& piece = pieces[piece_of[t]];
    const Vec3& origin = surface.point_at(3 * piece_of[t]);  // on the piece, so that little cancels
    const Vec3 doubled = area_vector_doubled(surface.mesh, surface.mesh.triangles[t]);
    piece.volume += (surface.point_at(3 * t) - origin).dot(doubled) / 6.0;
    piece.area += 0.5 * doubled.norm();
    ++piece.triangles;
    for (const std::int32_t v : surface.mesh.triangles[t]) {
      piece.low = piece.low.cwiseMin(surface.point(v));
      piece.high = piece.high.cwiseMax(surface.point(v));
    }
  }
  return pieces;
}

void turn_outwards(WorkSurface& surface, const std::vector<std::uint32_t>& piece_of,
                   std::vector<Piece>& pieces) {
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    if (pieces[piece_of[t]].volume < 0.0) surface.turn(t);
  }
  for (Piece& piece : pieces) piece.volume = std::abs(piece.volume);
}

Done drop_pieces(WorkSurface& surface, const std::vector<std::uint32_t>& piece_of,
                 const std::vector<std::uint8_t>& goes) {
  Done done;
  std::vector<std::uint8_t> doomed(piece_of.size());
  for (std::uint32_t t = 0; t < piece_of.size(); ++t) {
    doomed[t] = goes[piece_of[t]];
    done.times += piece_of[t] == t && doomed[t] != 0 ? 1 : 0;
  }
  done.triangles = surface.drop(doomed);
  return done;
}

/// Whether a point is inside a piece, by its winding number.
bool is_inside(const WorkSurface& surface, const std::vector<std::uint32_t>& piece_of, std::uint32_t piece,
               const Vec3& p) {
  double half_angles = 0.0;
  for (std::uint32_t t = 0; t < piece_of.size(); ++t) {
    if (piece_of[t] != piece) continue;
    half_angles += half_solid_angle(surface.point_at(3 * t) - p, surface.point_at(3 * t + 1) - p,
                                    surface.point_at(3 * t + 2) - p);
  }
  constexpr double kHalfTurn = 3.141592653589793;
  return half_angles > kHalfTurn;
}

void drop_scraps(WorkSurface& surface, PiecesDone& done) {
  const std::vector<std::uint32_t> piece_of = pieces_of(pair_sides(surface));
  std::vector<Piece> pieces = measured(surface, piece_of);
  turn_outwards(surface, piece_of, pieces);
  double largest = 0.0;
  double whole = 0.0;
  for (const Piece& piece : pieces) {
    largest = std::max(largest, piece.volume);
    whole += piece.volume;
  }
  const double area = surface.area();
  if (!(largest > kNoVolume * area * std::sqrt(area))) {
    done.refusal = "it encloses no volume";
    return;
  }
  std::vector<std::uint8_t> goes(pieces.size(), 0);
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    if (pieces[t].triangles == 0) continue;
    if (pieces[t].volume <= kScrap * largest) {
      goes[t] = 1;
      done.scraps_share += pieces[t].volume / whole;
    } else {
      ++done.kept;
    }
  }
  done.scraps = drop_pieces(surface, piece_of, goes);
  if (done.kept > kMostPieces) {
    done.refusal = fmt::format("it is {} separate pieces of like size, at most {} can be one organ",
                               done.kept, kMostPieces);
  }
}

/// Drops pieces inside others, unless they go through them.
void drop_inner(WorkSurface& surface, const std::vector<std::uint32_t>& piece_of, PiecesDone& done) {
  const std::vector<Piece> pieces = measured(surface, piece_of);
  std::vector<std::uint8_t> goes(pieces.size(), 0);
  for (std::uint32_t inner = 0; inner < pieces.size(); ++inner) {
    for (std::uint32_t outer = 0; outer < pieces.size() && pieces[inner].triangles > 0; ++outer) {
      if (outer == inner || pieces[outer].triangles == 0 || goes[inner] != 0) continue;
      if (!pieces[outer].holds(pieces[inner]) || pieces[outer].volume <= pieces[inner].volume) continue;
      if (is_inside(surface, piece_of, outer, surface.point_at(3 * inner))) goes[inner] = 1;
    }
  }
  done.inner = drop_pieces(surface, piece_of, goes);
  done.kept -= done.inner.times;
}

void account_for(const WorkSurface& surface, const Crossings& crossings, PiecesDone& done) {
  done.crossing_pairs = crossings.pairs.size();
  std::vector<std::uint8_t> crosses(surface.mesh.triangles.size(), 0);
  for (const auto& [s, t] : crossings.pairs) crosses[s] = crosses[t] = 1;
  double area = 0.0;
  for (std::size_t t = 0; t < crosses.size(); ++t) area += crosses[t] != 0 ? surface.area(t) : 0.0;
  done.crossing_share = area / surface.area();
}

}  // namespace

Done drop_open_scraps(WorkSurface& surface, const Mates& mates) {
  const std::vector<std::uint32_t> piece_of = pieces_of(mates);
  std::vector<double> area(piece_of.size(), 0.0);
  std::vector<std::uint8_t> is_open(piece_of.size(), 0);
  for (Corner c = 0; c < mates.size(); ++c) {
    if (mates[c] == kNoMate) is_open[piece_of[c / 3]] = 1;
  }
  double whole = 0.0;
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    area[piece_of[t]] += surface.area(t);
    whole += surface.area(t);
  }
  const auto largest = static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
  for (std::size_t t = 0; t < area.size(); ++t) {
    if (t == largest || area[t] > kScrap * whole) is_open[t] = 0;
  }
  return drop_pieces(surface, piece_of, is_open);
}

PiecesDone sort_out_pieces(WorkSurface& surface) {
  PiecesDone done;
  drop_scraps(surface, done);
  if (!done.refusal.empty()) return done;
  Crossings crossings = find_crossings(surface.mesh);
  if (done.kept > 1) {
    const std::vector<std::uint32_t> piece_of = pieces_of(pair_sides(surface));
    const auto joins_two = [&](const auto& pair) { return piece_of[pair[0]] != piece_of[pair[1]]; };
    if (std::any_of(crossings.pairs.begin(), crossings.pairs.end(), joins_two)) {
      account_for(surface, crossings, done);
      done.refusal = fmt::format("{} of its pieces go through each other (at {} pairs of triangles)",
                                 done.kept, crossings.pairs.size());
      return done;
    }
    drop_inner(surface, piece_of, done);
    if (done.inner.times > 0) crossings = find_crossings(surface.mesh);
  }
  account_for(surface, crossings, done);
  if (!crossings.all || done.crossing_share > kMostCrossing) {
    done.refusal = fmt::format("{}{} pairs of its triangles go through each other",
                               crossings.all ? "" : "at least ", done.crossing_pairs);
  }
  return done;
}

}  // namespace palpate::geometry
