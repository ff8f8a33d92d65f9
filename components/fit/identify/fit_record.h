#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] Hash of all inputs of a specimen's fit (data, index, settings, program version) as 32 hexadecimal
/// digits.
[[nodiscard]] std::string record_key(const Specimen& specimen, const Settings& settings, std::uint32_t job);

/// [setup] A fit as one line of JSON without line end. parse_record_line() restores it bit for bit.
[[nodiscard]] std::string record_line(const std::string& key, const SpecimenFit& fit);

/// [setup] Parses a line of record_line(). @throws InputError when the line is invalid.
[[nodiscard]] SpecimenFit parse_record_line(const std::string& line);

/// [setup] Hash of all inputs of a sweep piece: the request (as text), the index of the piece, the specimens
/// and the settings.
[[nodiscard]] std::string sweep_record_key(const std::string& request, std::size_t piece,
                                           const std::vector<Specimen>& specimens, const Settings& settings);

/// [setup] Checks that a line is a complete fit or sweep piece. @throws InputError or an exception of the
/// JSON library.
void check_line(const std::string& line);

/// [setup] A number for a results file. JSON has no infinite or NaN numbers; these are written as strings.
[[nodiscard]] nlohmann::ordered_json number_json(double value);

/// [setup] Reads a number written by number_json(). @throws InputError when it is not a number
[[nodiscard]] double number_of(const nlohmann::ordered_json& json);

/// [any] Conversion between numbers and bytes, for messages between ranks (not for files). @throws InputError
/// when the size of the bytes is not a whole number of values.
[[nodiscard]] std::string bytes_of(std::span<const double> values);
[[nodiscard]] std::vector<double> doubles_of(const std::string& bytes);
[[nodiscard]] std::string bytes_of(const std::vector<Specimen>& specimens);
[[nodiscard]] std::vector<Specimen> specimens_of(const std::string& bytes);

/// [setup] No result that is not finite may be printed or written. @param what of which quantity, for the
/// message @throws InputError
void require_finite_result(const std::string& what, double value);

}  // namespace palpate::identify
