#pragma once
#include <string>

#include <imgui.h>

namespace palpate::app {

/// A table of two columns, a name and what belongs to it; it ends with its life. [setup]
class Rows final {
 public:
  /// @param share of the width that names have
  explicit Rows(const char* name, float share = 0.44F);
  ~Rows();
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// The next row's name; what is drawn next stands beside it. @param explanation shown over the name
  void name(const char* text, const char* explanation = nullptr) const;
  /// A row of words.
  void text(const char* text, const std::string& value, const char* explanation = nullptr) const;
  /// A row with a number that can be dragged, or typed after a double click.
  /// @param per_unit what one of the shown units is in SI @param format with the unit, as for printf
  /// @return whether it was changed
  bool number(const char* text, double& value, double per_unit, double speed, double least, double most,
              const char* format, const char* explanation = nullptr) const;

 private:
  bool drawn_;
};

/// [setup] A number as printf has it.
[[nodiscard]] std::string formatted(const char* format, double value);

}  // namespace palpate::app
