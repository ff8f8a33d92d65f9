#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "io/mesh_io/mesh_file.h"

// Words and numbers of text mesh files, for mesh_file.cc and ply_check.cc.
namespace palpate::geometry {

/// Takes a text apart into lines, ended by \n, \r\n or \r.
class LineReader final {
 public:
  /// @param join_backslash a line that ends in \ goes on in the next (OBJ)
  explicit LineReader(std::string_view text, bool join_backslash = false)
      : rest_(text), joins_(join_backslash) {}

  /// Moves to the next line. @return false at the end.
  bool next();

  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t number() const { return number_; }  // the first is 1
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view take();

  std::string_view rest_;
  std::string_view line_;
  std::string joined_;
  std::size_t number_ = 0;
  std::size_t lines_taken_ = 0;
  bool joins_;
};

/// Takes the first word off `rest`; empty at its end.
std::string_view next_word(std::string_view& rest);

[[nodiscard]] std::optional<double> number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view word);

using Point = std::array<float, 3>;  // as the importer keeps it

/// The first three numbers of `rest`. @throws InputError starting with `where` when one is missing, no number
/// or not finite as a float.
[[nodiscard]] Point read_point(std::string_view rest, const std::string& where, std::size_t vertex);

/// @throws InputError when a coordinate is not finite.
void require_finite(const Point& point, const std::string& where, std::size_t vertex);

/// Bounds the work of cutting a file's polygons into triangles, which grows with the third power of their
/// corners.
class PolygonBudget final {
 public:
  /// @throws InputError starting with `where` when the polygon has too many corners, or the file too many
  /// such.
  void take(std::size_t corners, const std::string& where);

 private:
  std::uint64_t steps_ = 0;
};

/// Counts the places at which a file has vertices.
class PointSet final {
 public:
  std::size_t count = 0;
  void add(const Point& point);
  [[nodiscard]] FileFacts facts() const { return {true, count, distinct_.size(), {}, 0}; }

 private:
  struct Hash {
    std::size_t operator()(const Point& point) const noexcept;
  };
  std::unordered_set<Point, Hash> distinct_;
};

/// [setup] A surface that has been checked, as OBJ text: what the importer is given instead of the file, so
/// that it meets nothing that was not looked at.
class ObjText final {
 public:
  void add_point(const Point& point);
  /// The next corner of the face; index from 0.
  void add_corner(std::uint64_t vertex);
  void end_face();
  [[nodiscard]] std::string take() { return std::move(vertices_) + faces_; }

 private:
  std::string vertices_;
  std::string faces_;
  bool in_face_ = false;
};

/// [setup] `words` without control characters, each turned into '?': what a file says may stand in a message
/// of one line.
[[nodiscard]] std::string without_controls(std::string words);

}  // namespace palpate::geometry
