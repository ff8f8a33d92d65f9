#include "fit/identify/fit_record.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/content_hash.h"
#include "io/system/json_text.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"
#include "palpate/version.h"

#include "fit/identify/fit_fields.h"
#include "fit/identify/sweep.h"

namespace palpate::identify {
namespace {

using Json = nlohmann::ordered_json;

// Values of a results file: written() makes JSON that read() restores bit for bit.

Json written(const Interval& interval) {
  return Json::array({number_json(interval.low), number_json(interval.high)});
}

template <typename Fit>
Json fields_json(const Fit& fit);

template <typename Value>
Json written(const Value& value) {
  if constexpr (std::is_floating_point_v<Value>) {
    return number_json(value);
  } else if constexpr (std::is_same_v<Value, model::LawKind>) {
    return model::to_string(value);
  } else if constexpr (std::is_same_v<Value, Estimate> || std::is_same_v<Value, Curve>) {
    return fields_json(value);
  } else {
    return value;
  }
}

Json written(const std::optional<Interval>& interval) {
  return interval ? written(*interval) : Json(nullptr);
}

template <typename Value>
Json written(const std::vector<Value>& values) {
  Json json = Json::array();
  for (const Value& value : values) json.push_back(written(value));
  return json;
}

template <typename Fit>
Json fields_json(const Fit& fit) {
  Json json = Json::object();
  for_each_field(fit, [&json](const ResultField& field, const auto& value) {
    if ((field.outputs & kInRecord) != 0) json[field.key] = written(value);
  });
  return json;
}

template <typename Fit>
void read_fields(const Json& json, Fit& fit);

void read(const Json& json, Interval& interval) { interval = {number_of(json.at(0)), number_of(json.at(1))}; }

template <typename Value>
void read(const Json& json, Value& value) {
  if constexpr (std::is_floating_point_v<Value>) {
    value = number_of(json);
  } else if constexpr (std::is_same_v<Value, model::LawKind>) {
    value = model::parse_law(json.get<std::string>());
  } else if constexpr (std::is_same_v<Value, Estimate> || std::is_same_v<Value, Curve>) {
    read_fields(json, value);
  } else {
    value = json.get<Value>();
  }
}

void read(const Json& json, std::optional<Interval>& interval) {
  interval.reset();
  if (!json.is_null()) read(json, interval.emplace());
}

template <typename Value>
void read(const Json& json, std::vector<Value>& values) {
  values.clear();
  for (const Json& value : json) read(value, values.emplace_back());
}

template <typename Fit>
void read_fields(const Json& json, Fit& fit) {
  for_each_field(fit, [&json](const ResultField& field, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    if ((field.outputs & kInRecord) == 0) return;
    if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
      value = whole_number<Value>(json, field.key);
    } else {
      read(json.at(field.key), value);
    }
  });
}

bool all_as_long(const std::vector<Point>& points, std::size_t size) {
  return std::all_of(points.begin(), points.end(),
                     [size](const Point& point) { return point.size() == size; });
}

void check_lengths(const SpecimenFit& fit) {
  const Curve& curve = fit.curve;
  const std::size_t points = curve.displacement.size();
  if ((!curve.time.empty() && curve.time.size() != points) ||
      !all_as_long({curve.measured, curve.fitted, curve.low, curve.high}, points)) {
    throw InputError("results line: its curve has not as many values in every column");
  }
  if (fit.terms > model::kMaxRelaxationTerms || fit.shared.size() != shared_count(fit.terms) ||
      fit.own.size() != kOwnParameters ||
      !all_as_long(fit.local_optima, fit.shared.size() + kOwnParameters) ||
      fit.estimates.size() != fit.shared.size() + kOwnParameters) {
    throw InputError("results line: does not have as many parameters as it has relaxation terms");
  }
}

void put(std::string& bytes, std::uint64_t value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put(std::string& bytes, const std::string& text) {
  put(bytes, text.size());
  bytes += text;
}

/// Reads a length-prefixed text at `at` and moves `at` behind it.
std::string take(const std::string& bytes, std::size_t& at) {
  std::uint64_t size = 0;
  if (bytes.size() - at < sizeof size) throw InputError("specimens between ranks: cut off");
  std::memcpy(&size, bytes.data() + at, sizeof size);
  at += sizeof size;
  if (bytes.size() - at < size) throw InputError("specimens between ranks: cut off");
  at += size;
  return bytes.substr(at - size, size);
}

}  // namespace

nlohmann::ordered_json number_json(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0.0 ? "inf" : "-inf";
}

double number_of(const nlohmann::ordered_json& json) {
  if (json.is_number()) return json.get<double>();
  const std::string word = json.is_string() ? json.get<std::string>() : json.dump();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (word == "inf") return std::numeric_limits<double>::infinity();
  if (word == "-inf") return -std::numeric_limits<double>::infinity();
  throw InputError("\"" + word + "\" is no number");
}

std::string record_key(const Specimen& specimen, const Settings& settings, std::uint32_t job) {
  constexpr std::uint64_t kFormat = 7;  // version of the line format
  const std::string version = kVersion;
  ContentHasher hasher;
  hasher.add(kFormat);
  hasher.add(std::as_bytes(std::span<const char>(version)));
  hasher.add(std::as_bytes(std::span<const char>(specimen.name)));
  hasher.add(std::span<const double>(specimen.time));
  hasher.add(std::span<const double>(specimen.displacement));
  hasher.add(std::span<const double>(specimen.force)).add(specimen.tip_radius);
  hasher.add(static_cast<int>(settings.law)).add(static_cast<int>(settings.direction));
  hasher.add(settings.relaxation ? 1 : 0).add(settings.period).add(settings.t1);
  hasher.add(settings.bootstrap).add(settings.seed).add(job);
  return hasher.hash().hexadecimal();
}

std::string sweep_record_key(const std::string& request, std::size_t piece,
                             const std::vector<Specimen>& specimens, const Settings& settings) {
  ContentHasher hasher;
  hasher.add(std::as_bytes(std::span<const char>(request))).add(static_cast<std::uint64_t>(piece));
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    const std::string key = record_key(specimens[i], settings, static_cast<std::uint32_t>(i));
    hasher.add(std::as_bytes(std::span<const char>(key)));
  }
  return hasher.hash().hexadecimal();
}

std::string record_line(const std::string& key, const SpecimenFit& fit) {
  Json json = {{"key", key}};
  json.update(fields_json(fit));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SpecimenFit parse_record_line(const std::string& line) {
  try {
    SpecimenFit fit;
    read_fields(Json(parse_json(line)), fit);
    check_lengths(fit);
    return fit;
  } catch (const Json::exception& error) {
    throw InputError(std::string("results line: ") + error.what());
  }
}

void check_line(const std::string& line) {
  if (!parse_json(line).contains("points_swept")) {
    (void)parse_record_line(line);
    return;
  }
  Sweep sweep;
  add_sweep_line(line, sweep);
}

std::string bytes_of(std::span<const double> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

std::vector<double> doubles_of(const std::string& bytes) {
  if (bytes.size() % sizeof(double) != 0) throw InputError("numbers between ranks: cut off");
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty())
    std::memcpy(values.data(), bytes.data(), bytes.size());  // data() of an empty vector may be null
  return values;
}

std::string bytes_of(const std::vector<Specimen>& specimens) {
  std::string bytes;
  for (const Specimen& specimen : specimens) {
    put(bytes, specimen.name);
    put(bytes, bytes_of(std::span<const double>(specimen.time)));
    put(bytes, bytes_of(std::span<const double>(specimen.displacement)));
    put(bytes, bytes_of(std::span<const double>(specimen.force)));
    put(bytes, std::to_string(specimen.empty_rows));
    put(bytes, bytes_of(std::span<const double>(&specimen.tip_radius, 1)));
  }
  return bytes;
}

std::vector<Specimen> specimens_of(const std::string& bytes) {
  std::vector<Specimen> specimens;
  for (std::size_t at = 0; at < bytes.size();) {
    Specimen specimen;
    specimen.name = take(bytes, at);
    specimen.time = doubles_of(take(bytes, at));
    specimen.displacement = doubles_of(take(bytes, at));
    specimen.force = doubles_of(take(bytes, at));
    specimen.empty_rows = std::stoul(take(bytes, at));
    specimen.tip_radius = doubles_of(take(bytes, at)).at(0);
    specimens.push_back(std::move(specimen));
  }
  return specimens;
}

void require_finite_result(const std::string& what, double value) {
  if (std::isfinite(value)) return;
  throw InputError(fmt::format(
      "the fit gave no number for the {}: look at the data for rows far from all others, and at their units",
      what));
}

}  // namespace palpate::identify
