#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/scene/scene_keys.h"
#include "palpate/error.h"

#include "fit/sweep/sweep.h"

namespace palpate::sweep {
namespace {

std::vector<std::string> split(const std::string& text, char between) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(between); end != std::string::npos; end = text.find(between, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

/// Parses LOW:HIGH:N or LOW:HIGH:N:log; empty when the form is wrong. Values have at most 12 digits, so that
/// 0.1:0.7:7 contains exactly 0.2.
std::vector<std::string> spaced(const std::vector<std::string>& parts) {
  if (parts.size() < 3 || parts.size() > 4) return {};
  const std::optional<double> low = parse_number(parts[0]);
  const std::optional<double> high = parse_number(parts[1]);
  const std::optional<double> count = parse_number(parts[2]);
  const bool logarithmic = parts.size() == 4;
  if (!low || !high || !count || (logarithmic && (parts[3] != "log" || !(*low > 0.0)))) return {};
  if (!(*low < *high) || !std::isfinite(*high - *low)) return {};
  if (!(*count >= 2.0 && *count <= kMostRuns) || *count != std::floor(*count)) return {};
  std::vector<std::string> values;
  for (double i = 0.0; i < *count; ++i) {
    const double share = i / (*count - 1.0);
    const double value =
        logarithmic ? portable::exp((1.0 - share) * portable::log(*low) + share * portable::log(*high))
                    : *low + share * (*high - *low);
    const double rounded = *parse_number(fmt::format("{:.12g}", value));
    const bool whole = rounded == std::floor(rounded) && std::abs(rounded) < 1e15;
    values.push_back(whole ? fmt::format("{:.0f}", rounded) : shortest(rounded));
  }
  return values;
}

}  // namespace

bool Axis::number() const noexcept {
  return type == scene::KeyType::kNumber || type == scene::KeyType::kWhole;
}

Axis parse_axis(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  const scene::SceneKey& key = scene::find_scene_key(flag, text.substr(0, equals));
  const std::string right = equals == std::string::npos ? "" : text.substr(equals + 1);
  Axis axis{key.path, key.type, {}};
  const bool range = axis.number() && right.find(':') != std::string::npos;
  axis.values = range ? spaced(split(right, ':')) : split(right, ',');
  if (right.empty() || axis.values.empty()) {
    throw InputError(
        fmt::format("{} {}: must be KEY=LOW:HIGH:N with LOW < HIGH and N from 2 to {}, :log after it for "
                    "even steps of the "
                    "logarithm, or KEY=VALUE,VALUE,...",
                    flag, text, kMostRuns));
  }
  for (const std::string& value : axis.values) key.check(flag, value);
  for (auto value = axis.values.begin(); value != axis.values.end(); ++value) {
    if (std::find(axis.values.begin(), value, *value) == value) continue;
    throw InputError(fmt::format("{} {}: has the value {} twice", flag, text, *value));
  }
  return axis;
}

}  // namespace palpate::sweep
