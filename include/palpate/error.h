#pragma once
#include <stdexcept>
#include <string>

namespace palpate {

/// Bad input from outside (a file, a flag, a parameter): the message is one line that names the file, the
/// field or line, the value and what would be right. The program ends with exit code 2 on it.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A parameter out of its range; the message names the field, its value and its unit.
class ParameterError final : public InputError {
 public:
  /// @param field name as the user types it, with its unit, e.g. "k1_N_per_m"
  /// @param value as the user would type it, in that unit
  /// @param want what would be right, e.g. "finite and > 0"
  ParameterError(const std::string& field, double value, const std::string& want);

  [[nodiscard]] const std::string& field() const noexcept { return field_; }

 private:
  std::string field_;
};

}  // namespace palpate
