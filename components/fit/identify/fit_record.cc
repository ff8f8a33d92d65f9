#include "fit/identify/fit_record.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/content_hash.h"
#include "io/system/json_text.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"
#include "palpate/version.h"

#include "fit/identify/number_json.h"
#include "fit/identify/sweep_piece.h"

namespace palpate::identify {
namespace {

using Json = nlohmann::ordered_json;

Json list_json(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(number_json(value));
  return json;
}

std::vector<double> list_of(const Json& json) {
  std::vector<double> values;
  for (const Json& value : json) values.push_back(number_of(value));
  return values;
}

Json interval_json(const Interval& interval) {
  return Json::array({number_json(interval.low), number_json(interval.high)});
}

Json interval_json(const std::optional<Interval>& interval) {
  return interval ? interval_json(*interval) : Json(nullptr);
}

Interval interval_of(const Json& json) { return {number_of(json.at(0)), number_of(json.at(1))}; }

std::optional<Interval> maybe_interval_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return interval_of(json);
}

Json estimate_json(const Estimate& estimate) {
  return {{"value", number_json(estimate.value)},
          {"interval", interval_json(estimate.interval)},
          {"covariance", interval_json(estimate.covariance)},
          {"bootstrap", interval_json(estimate.bootstrap)},
          {"determined", estimate.determined}};
}

Estimate estimate_of(const Json& json) {
  Estimate estimate;
  estimate.value = number_of(json.at("value"));
  estimate.interval = interval_of(json.at("interval"));
  estimate.covariance = maybe_interval_of(json.at("covariance"));
  estimate.bootstrap = maybe_interval_of(json.at("bootstrap"));
  estimate.determined = json.at("determined").get<bool>();
  return estimate;
}

Json curve_json(const Curve& curve) {
  return {{"time", list_json(curve.time)},         {"displacement", list_json(curve.displacement)},
          {"measured", list_json(curve.measured)}, {"fitted", list_json(curve.fitted)},
          {"low", list_json(curve.low)},           {"high", list_json(curve.high)}};
}

Curve curve_from_json(const Json& json) {
  Curve curve;
  curve.time = list_of(json.at("time"));
  curve.displacement = list_of(json.at("displacement"));
  curve.measured = list_of(json.at("measured"));
  curve.fitted = list_of(json.at("fitted"));
  curve.low = list_of(json.at("low"));
  curve.high = list_of(json.at("high"));
  const std::size_t points = curve.displacement.size();
  if ((!curve.time.empty() && curve.time.size() != points) || curve.measured.size() != points ||
      curve.fitted.size() != points || curve.low.size() != points || curve.high.size() != points) {
    throw InputError("results line: its curve has not as many values in every column");
  }
  return curve;
}

bool all_as_long(const std::vector<Point>& points, std::size_t size) {
  return std::all_of(points.begin(), points.end(),
                     [size](const Point& point) { return point.size() == size; });
}

SpecimenFit fit_of_json(const Json& json) {
  SpecimenFit fit;
  fit.name = json.at("name").get<std::string>();
  fit.law = model::parse_law(json.at("law").get<std::string>());
  fit.layers_allowed = whole_number<int>(json, "layers_allowed");
  fit.layers_reached = whole_number<int>(json, "layers_reached");
  fit.terms = whole_number<std::size_t>(json, "terms");
  for (const Json& estimate : json.at("estimates")) fit.estimates.push_back(estimate_of(estimate));
  fit.rms = number_of(json.at("rms"));
  fit.nrmse = number_of(json.at("nrmse"));
  fit.cross_validation = number_of(json.at("leave_out"));
  fit.points = whole_number<std::size_t>(json, "points");
  fit.rows = whole_number<std::size_t>(json, "rows");
  fit.warnings = json.at("warnings").get<std::vector<std::string>>();
  fit.curve = curve_from_json(json.at("curve"));
  fit.shared = list_of(json.at("shared"));
  fit.own = list_of(json.at("own"));
  for (const Json& minimum : json.at("minima")) fit.local_optima.push_back(list_of(minimum));
  if (fit.terms > model::kMaxRelaxationTerms || fit.shared.size() != shared_count(fit.terms) ||
      fit.own.size() != kOwnParameters ||
      !all_as_long(fit.local_optima, fit.shared.size() + kOwnParameters) ||
      fit.estimates.size() != fit.shared.size() + kOwnParameters) {
    throw InputError("results line: does not have as many parameters as it has relaxation terms");
  }
  return fit;
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

std::string record_key(const Specimen& specimen, const Settings& settings, std::uint32_t job) {
  constexpr std::uint64_t kFormat = 3;  // version of the line format
  const std::string version = kVersion;
  ContentHasher hasher;
  hasher.add(kFormat);
  hasher.add(std::as_bytes(std::span<const char>(version)));
  hasher.add(std::as_bytes(std::span<const char>(specimen.name)));
  hasher.add(std::span<const double>(specimen.time));
  hasher.add(std::span<const double>(specimen.displacement));
  hasher.add(std::span<const double>(specimen.force));
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
  Json estimates = Json::array();
  for (const Estimate& estimate : fit.estimates) estimates.push_back(estimate_json(estimate));
  Json optima = Json::array();
  for (const Point& minimum : fit.local_optima) optima.push_back(list_json(minimum));
  const Json json = {{"key", key},
                     {"name", fit.name},
                     {"law", model::to_string(fit.law)},
                     {"layers_allowed", fit.layers_allowed},
                     {"layers_reached", fit.layers_reached},
                     {"terms", fit.terms},
                     {"estimates", std::move(estimates)},
                     {"rms", number_json(fit.rms)},
                     {"nrmse", number_json(fit.nrmse)},
                     {"leave_out", number_json(fit.cross_validation)},
                     {"points", fit.points},
                     {"rows", fit.rows},
                     {"warnings", fit.warnings},
                     {"curve", curve_json(fit.curve)},
                     {"shared", list_json(fit.shared)},
                     {"own", list_json(fit.own)},
                     {"minima", std::move(optima)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SpecimenFit parse_record_line(const std::string& line) {
  try {
    return fit_of_json(parse_json(line));
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
    specimens.push_back(std::move(specimen));
  }
  return specimens;
}

}  // namespace palpate::identify
