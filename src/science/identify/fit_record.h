#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] What a specimen's fit depends on as 32 hexadecimal digits: the data, its number, the settings and
/// the program's version.
[[nodiscard]] std::string key_of(const Specimen& specimen, const Settings& settings, std::uint32_t job);

/// [setup] A fit as one line of JSON without the line's end, to the bit.
[[nodiscard]] std::string line_of(const std::string& key, const SpecimenFit& fit);

/// [setup] The fit of such a line. @throws InputError when the line is not one.
[[nodiscard]] SpecimenFit fit_of(const std::string& line);

/// [setup] What a piece of a sweep depends on: the fits that it begins at, the request (as text) and which
/// piece it is.
[[nodiscard]] std::string sweep_key_of(const std::string& request, std::size_t piece,
                                       const std::vector<Specimen>& specimens, const Settings& settings);

/// [setup] @throws InputError, or what the JSON library throws, unless the line is a whole one of a fit or of
/// a sweep.
void check_line(const std::string& line);

/// [any] Numbers as bytes and back; for between ranks, not for files. @throws InputError when the bytes are
/// not whole numbers.
[[nodiscard]] std::string bytes_of(std::span<const double> values);
[[nodiscard]] std::vector<double> doubles_of(const std::string& bytes);
[[nodiscard]] std::string bytes_of(const std::vector<Specimen>& specimens);
[[nodiscard]] std::vector<Specimen> specimens_of(const std::string& bytes);

}  // namespace palpate::identify
