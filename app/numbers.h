#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "palpate/error.h"

namespace palpate::app {

/// Which finite numbers a flag takes.
enum class Numbers { kAny, kNotNegative, kPositive };

/// [setup] The number that `text` is, all of it: no spaces, no sign +, no hexadecimal. @param flag as the
/// user typed it, e.g. "--rate-Hz". @throws InputError naming flag and text when it is none of these.
[[nodiscard]] double parse_number(const std::string& flag, const std::string& text, Numbers numbers);
[[nodiscard]] double parse_positive(const std::string& flag, const std::string& text);

/// [setup] Numbers >= 0 between commas, at least one. @throws InputError naming flag and the bad entry.
[[nodiscard]] std::vector<double> parse_not_negative_list(const std::string& flag, const std::string& text);

/// [setup] A whole number 0 .. 2^64-1. @throws InputError naming flag and text.
[[nodiscard]] std::uint64_t parse_whole(const std::string& flag, const std::string& text);

/// [setup] Gives a command a flag with a number, which is `value` in SI. @param value a double, or an
/// optional one @param unit what the flag's unit is in SI
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

/// [setup] Gives a command a flag with a whole number 0 .. 2^64-1.
CLI::Option* add_whole(CLI::App& command, const std::string& flag, std::uint64_t& value,
                       const std::string& help);

/// [setup] Gives a command a flag that takes one of some names, each for a value.
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

}  // namespace palpate::app
