#pragma once
#include <stdexcept>
#include <string>

namespace palpate {

/// Invalid input from a file, a flag or a parameter. The message is one line. It names the file, the field or
/// line, the value and the valid values. The program then ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A parameter is out of its range. The message names the field, its value and its unit.
class ParameterError final : public InputError {
 public:
  /// @param field name as the user types it, with its unit: "k1_N_per_m"
  /// @param value in that unit
  /// @param want the valid values: "finite and > 0"
  ParameterError(const std::string& field, double value, const std::string& want);

  [[nodiscard]] const std::string& field() const noexcept { return field_; }

 private:
  std::string field_;
};

}  // namespace palpate
