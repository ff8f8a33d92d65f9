#pragma once
#include <string>

#include <imgui.h>

namespace palpate::app {

/// Table of two columns, a name and its value. The destructor ends the table. [setup]
class Rows final {
 public:
  /// @param share fraction of the width for the names
  explicit Rows(const char* name, float share = 0.44F);
  ~Rows();
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// Writes the name of the next row; the next widget is drawn beside it. @param explanation tooltip of the
  /// name
  void name(const char* text, const char* explanation = nullptr) const;
  /// Writes a row of text.
  void text(const char* text, const std::string& value, const char* explanation = nullptr) const;
  /// Draws a row with a number that can be dragged, or typed after a double click.
  /// @param per_unit SI value of one displayed unit @param format of printf, with the unit
  /// @return whether the number was changed
  bool number(const char* text, double& value, double per_unit, double speed, double least, double most,
              const char* format, const char* explanation = nullptr) const;

 private:
  bool drawn_;
};

/// [setup] A number formatted by printf.
[[nodiscard]] std::string formatted(const char* format, double value);

}  // namespace palpate::app
