#include "app/numbers.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include <fmt/core.h>

#include "core/base/parallel.h"

namespace palpate::app {
namespace {

[[noreturn]] void refuse(const std::string& flag, const std::string& text, const std::string& want) {
  throw InputError(fmt::format("{} {}: must be {}", flag, text.empty() ? "(empty)" : text, want));
}

template <typename T>
bool read_all(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

double parse_number(const std::string& flag, const std::string& text, Numbers numbers) {
  double value = 0.0;
  const bool finite = read_all(text, value) && std::isfinite(value);
  if (!finite || (numbers == Numbers::kNotNegative && value < 0.0) ||
      (numbers == Numbers::kPositive && value <= 0.0)) {
    refuse(flag, text,
           numbers == Numbers::kAny           ? "a finite number"
           : numbers == Numbers::kNotNegative ? "a finite number >= 0"
                                              : "a finite number > 0");
  }
  return value;
}

double parse_positive(const std::string& flag, const std::string& text) {
  return parse_number(flag, text, Numbers::kPositive);
}

std::vector<double> parse_not_negative_list(const std::string& flag, const std::string& text) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = text.find(',', begin);
    const std::string entry = text.substr(begin, comma == std::string::npos ? comma : comma - begin);
    double value = 0.0;
    if (!read_all(entry, value) || !std::isfinite(value) || value < 0.0) {
      const std::string shown = entry.empty() ? "an empty entry" : "'" + entry + "'";
      const std::string which = entry == text ? "" : " (not " + shown + ")";
      refuse(flag, text, "finite numbers >= 0, separated by commas, e.g. 0.05,0.5" + which);
    }
    values.push_back(value);
    if (comma == std::string::npos) return values;
    begin = comma + 1;
  }
}

std::uint64_t parse_whole(const std::string& flag, const std::string& text) {
  std::uint64_t value = 0;
  if (!read_all(text, value)) refuse(flag, text, "a whole number >= 0 and < 2^64");
  return value;
}

CLI::Option* add_whole(CLI::App& command, const std::string& flag, std::uint64_t& value,
                       const std::string& help) {
  return command.add_option_function<std::string>(
      flag, [&value, flag](const std::string& text) { value = parse_whole(flag, text); }, help);
}

void add_jobs(CLI::App& command) {
  command.add_option_function<std::string>(
      "--jobs",
      [](const std::string& text) {
        static std::optional<ThreadLimit> limit;  // until the program ends
        const std::uint64_t most = parse_whole("--jobs", text);
        if (most < 1) throw InputError("--jobs " + text + ": must be at least 1");
        limit.emplace(most);
      },
      "threads; results are the same for any number (default: all processors)");
}

}  // namespace palpate::app
