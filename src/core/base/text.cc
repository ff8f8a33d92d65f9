#include "core/base/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <system_error>
#include <vector>

#include "core/base/charconv.h"

namespace palpate {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7f) c = ' ';
  }
  return text;
}

std::string shortest(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> buffer{};
  const auto end = to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string brief(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

int decimals_of_step(double step) noexcept {
  constexpr int kMost = 6;
  constexpr double kSame = 1e-6;  // of the step, for its rounding error
  double scaled = step;
  for (int decimals = 0; decimals < kMost; ++decimals, scaled *= 10.0) {
    if (std::abs(scaled - std::round(scaled)) <= kSame * std::abs(scaled)) return decimals;
  }
  return kMost;
}

std::string percent(double share, int decimals) {
  std::array<char, 352> text{};  // the largest double has 309 digits before the point
  std::snprintf(text.data(), text.size(), "%.*f %%", decimals, 100.0 * share);
  return text.data();
}

std::string counted(std::uint64_t number, std::string_view one, std::string_view more) {
  return std::to_string(number).append(" ").append(number == 1 ? one : more);
}

std::string lower_case(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

std::string joined(std::span<const std::string> words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    if (&word != words.data()) text += between;
    text += word;
  }
  return text;
}

std::string_view trimmed(std::string_view text) noexcept {
  constexpr std::string_view kBlank = " \t\v\f\r\n";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::string excerpt(std::string_view text, std::size_t most) {
  if (text.size() <= most) return one_line(std::string(text));
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0U) == 0x80) --most;  // within a character
  return one_line(std::string(text.substr(0, most))) + "...";
}

std::optional<double> parse_number(std::string_view text) noexcept {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string nearest_word(std::string_view word, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string other_unit(std::string_view name, std::string_view meant) {
  static constexpr std::string_view kUnits[] = {"m",  "mm", "cm",  "um",  "nm",  "in",  "N",  "mN",
                                                "uN", "kN", "gf",  "kgf", "g",   "kg",  "s",  "ms",
                                                "us", "ns", "min", "h",   "deg", "rad", "Pa", "kPa"};
  const std::size_t end = name.rfind('_');
  if (end == std::string_view::npos || meant.rfind('_') != end || !meant.starts_with(name.substr(0, end)))
    return {};
  const auto is_unit = [](std::string_view word) {
    return std::find(std::begin(kUnits), std::end(kUnits), word) != std::end(kUnits);
  };
  if (name == meant || !is_unit(name.substr(end + 1)) || !is_unit(meant.substr(end + 1))) return {};
  std::size_t from = end;
  if (name.substr(0, end).ends_with("_per")) from = name.rfind('_', end - 5);  // "N_per_mm"
  return ", with values in " + std::string(meant.substr(from + 1)) + ", not " +
         std::string(name.substr(from + 1));
}

}  // namespace palpate
