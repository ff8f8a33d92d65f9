#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::fit {

/// A measured deformation of the surface around one contact: how far each place moved along the tool's
/// direction. SI.
struct Deformation {
  std::string name;
  double depth = 0.0;                // D [m], of the tool into the rest surface; 0: the file does not say
  std::vector<double> distance;      // r [m] from the contact along the surface at rest, rising from >= 0
  std::vector<double> displacement;  // u [m], with the tool counts positive

  [[nodiscard]] std::size_t size() const noexcept { return distance.size(); }
};

inline constexpr std::size_t kFewestPlaces = 5;

/// [setup] The deformations of one CSV file with columns r_mm, u_mm and optionally depth_mm, by header name;
/// lines that begin with # and blank lines do not count. Rows of one depth_mm are one deformation, named
/// after the file and its depth. r_mm < 0 is the other side of the contact and counts as its distance. Rows
/// may stand in any order.
/// @throws InputError naming file, line, column and value: no such file, a header that is missing or unknown,
/// a value that is no finite number, a depth that is not > 0, fewer than kFewestPlaces rows, places or
/// displacements that are all the same, displacements that grow away from the contact (a wrong sign).
[[nodiscard]] std::vector<Deformation> read_deformations(const std::filesystem::path& file);

/// [setup] Refuses what no profile can be compared with, and sorts by distance. @param where for the message
/// @throws InputError as read_deformations().
void check_deformation(Deformation& deformation, const std::string& where);

/// [setup] At most `most` places, each the mean of as many neighbours as that takes. A deformation, sorted by
/// distance, that has no more is returned as it is.
[[nodiscard]] Deformation thinned(const Deformation& deformation, std::size_t most);

}  // namespace palpate::fit
