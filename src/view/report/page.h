#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "view/report/gnuplot.h"

namespace palpate::report {

/// A table's cells, as HTML already (escape text with escaped()).
using TableRows = std::vector<std::vector<std::string>>;

/// [setup] @throws InputError when the report's folder cannot be made.
void make_report_folder(const std::filesystem::path& folder);

/// Builds one HTML page that needs nothing from outside: style and pictures are inside. Text arguments are
/// plain and get escaped here; arguments named `html` are taken as they are.
class Page final {
 public:
  /// [setup] @param title of the page and its first heading
  Page(const std::string& title, const std::string& subtitle);

  /// Begins a section, which goes on to the next one.
  void section(const std::string& id, const std::string& heading);
  void heading(const std::string& text);
  void paragraph(const std::string& html);
  void code(const std::string& text);
  /// Nothing for no items.
  void list(const std::vector<std::string>& items);
  void html_list(const std::vector<std::string>& html_items, const std::string& css_class);
  /// Two columns: name and value.
  void facts(const std::vector<std::pair<std::string, std::string>>& rows);
  /// First row is the head; the first column names the rows.
  void table(const TableRows& html_rows);
  void open_grid(const std::string& css_class);
  void close_grid();
  /// The pictures go into the page, in a grid; a missing one leaves its reason in words. @throws InputError
  /// when a file cannot be read.
  void figures(const std::string& css_class, const std::vector<Figure>& figures);

  /// The whole page.
  [[nodiscard]] std::string html() const;
  /// Writes the page as report.html. @return the file @throws InputError when it cannot be written.
  [[nodiscard]] std::filesystem::path write(const std::filesystem::path& folder) const;

 private:
  void figure(const Figure& figure);

  bool in_section_ = false;
  std::string title_;
  std::string body_;
};

}  // namespace palpate::report
