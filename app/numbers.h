#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"

#include "app/cli.h"

namespace palpate::app {

/// Which finite numbers a flag accepts.
enum class Numbers { kAny, kNotNegative, kPositive };

/// [setup] Parses a decimal number. The text must contain nothing else: no spaces, no plus sign. Hexadecimal
/// numbers are rejected. @param flag name of the flag in error messages, e.g. "--rate-Hz" @throws InputError
/// naming flag and text when the number is invalid or outside `numbers`.
[[nodiscard]] double parse_number(const std::string& flag, const std::string& text, Numbers numbers);
/// [setup] Parses a number > 0, as parse_number() does.
[[nodiscard]] double parse_positive(const std::string& flag, const std::string& text);

/// [setup] Parses one or more numbers >= 0, separated by commas. @throws InputError naming the flag and the
/// invalid entry.
[[nodiscard]] std::vector<double> parse_not_negative_list(const std::string& flag, const std::string& text);

/// [setup] Parses a whole number from 0 to 2^64-1. @throws InputError naming flag and text.
[[nodiscard]] std::uint64_t parse_whole(const std::string& flag, const std::string& text);

/// [setup] Adds a flag that takes a number to a command. The number times `unit` is stored in `value`.
/// @param value double or std::optional<double>, in SI units; outlives the parse @param unit size of the
/// flag's unit in SI units, e.g. kMillimetre
template <typename Value>
CLI::Option* add_number(CLI::App& command, const std::string& flag, Value& value, Numbers numbers,
                        const std::string& help, double unit = 1.0) {
  return command.add_option_function<std::string>(
      flag,
      [&value, flag, numbers, unit](const std::string& text) {
        value = parse_number(flag, text, numbers) * unit;
      },
      help);
}

/// [setup] Adds a flag that takes a whole number from 0 to 2^64-1 to a command.
CLI::Option* add_whole(CLI::App& command, const std::string& flag, std::uint64_t& value,
                       const std::string& help);

/// [setup] Adds a flag that takes one of several names to a command. Each name selects a value.
template <typename Value, typename Choice>
CLI::Option* add_choice(CLI::App& command, const std::string& flag, Value& value,
                        std::vector<std::pair<std::string, Choice>> choices, const std::string& help) {
  return command.add_option_function<std::string>(
      flag,
      [&value, flag, choices = std::move(choices)](const std::string& text) {
        std::string names;
        for (const auto& [name, choice] : choices) {
          if (name == text) {
            value = choice;
            return;
          }
          names += (names.empty() ? "" : " or ") + name;
        }
        throw InputError(flag + " " + text + ": must be " + names);
      },
      help);
}

/// [setup] Adds --jobs to a command with many tasks: the most threads that this process uses for them.
/// Default: all processors. Results are the same for any number.
void add_jobs(CLI::App& command);

}  // namespace palpate::app
