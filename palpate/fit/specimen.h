#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::fit {

/// One measured force over displacement, pressed or pulled; both count positive. SI.
struct Specimen {
  std::string name;
  std::vector<double> time;          // s, rising; empty when the file has none
  std::vector<double> displacement;  // m
  std::vector<double> force;         // N

  [[nodiscard]] std::size_t size() const noexcept { return force.size(); }
};

inline constexpr std::size_t kFewestPoints = 10;

/// [setup] The specimens of one CSV file with columns displacement_mm, force_N and optionally time_s and
/// specimen, by header name; lines that begin with # and blank lines do not count. A file without a specimen
/// column is one specimen, named after the file.
/// @throws InputError naming file, line, column and value, or file and specimen: no such file, a header that
/// is missing or unknown, a value that is no finite number, time that does not rise, fewer than kFewestPoints
/// rows, a displacement or force that never changes, signs other than the contract's.
[[nodiscard]] std::vector<Specimen> read_specimens(const std::filesystem::path& file);

/// [setup] At most `most` points, each the mean of as many neighbours as that takes: neighbours in time, or,
/// without times, in displacement. A specimen that has no more is returned as it is.
[[nodiscard]] Specimen thinned(const Specimen& specimen, std::size_t most);

}  // namespace palpate::fit
