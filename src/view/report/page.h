#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "view/report/figures.h"

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

  void open_section(const std::string& id, const std::string& heading);
  void close_section();
  void heading(const std::string& text);
  void paragraph(const std::string& html);
  void code(const std::string& text);
  void list(const std::vector<std::string>& html_items, const std::string& css_class = "");
  /// Two columns: name and value.
  void facts(const std::vector<std::pair<std::string, std::string>>& rows);
  /// First row is the head; the first column names the rows.
  void table(const TableRows& html_rows);
  void open_grid(const std::string& css_class);
  void close_grid();
  /// The picture goes into the page; a missing one leaves its reason in words. @throws InputError when the
  /// file cannot be read.
  void figure(const Figure& figure);

  /// The whole page.
  [[nodiscard]] std::string html() const;
  /// Writes the page as report.html. @return the file @throws InputError when it cannot be written.
  [[nodiscard]] std::filesystem::path write(const std::filesystem::path& folder) const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace palpate::report
