#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "palpate/error.h"
#include "palpate/pose.h"

namespace palpate::scene {

/// Valid values of a number in a file; both ends are included unless low_excluded.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;

  [[nodiscard]] bool contains(double value) const noexcept {
    return (low_excluded ? value > low : value >= low) && value <= high;
  }
  /// [setup] "a finite number > 0", for messages.
  [[nodiscard]] std::string to_string() const;
};

inline constexpr Range kAnyNumber{};
inline constexpr Range kNotNegative{0.0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::infinity(), true};

inline constexpr std::size_t kLongestText = 4096;  // bytes; Linux allows no longer path
inline constexpr std::size_t kLongestName = 256;   // bytes of a name that is shown, as in a window's title

/// A TOML file in memory, with its name for messages.
struct TomlFile {
  std::string name;
  toml::table root;
};

/// [setup] Reads and parses a file. @throws InputError naming the file (and the line).
[[nodiscard]] TomlFile read_toml(const std::filesystem::path& file);

/// [setup] Parses a text; the only place where the program parses TOML (tools/lint_sources). @param name used
/// in messages as the file's name @throws InputError naming the line, also for a text that is nested deeper
/// than kMaxNesting.
[[nodiscard]] TomlFile parse_toml(const std::string& text, const std::string& name);

/// One table of a TOML file, read key by key. Every error is one line, FILE:LINE: field = value: what would
/// be right. All functions are [setup] and throw InputError.
class TomlTable final {
 public:
  /// @param field the table's path ("tool.jaw"), empty for the root
  TomlTable(std::string file, std::string field, const toml::table& table, int line);
  /// The root table of a file.
  explicit TomlTable(const TomlFile& file) : TomlTable(file.name, "", file.root, 1) {}

  /// Call before reading. @throws InputError at the first key that is not in `known`, with the nearest valid
  /// key.
  void allow_only(const std::vector<std::string>& known) const;

  /// Whether the table has the key, with any value.
  [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }
  /// A finite number; integers are accepted.
  [[nodiscard]] std::optional<double> number(std::string_view key, const Range& range = kAnyNumber) const;
  [[nodiscard]] double required_number(std::string_view key, const Range& range = kAnyNumber) const;
  [[nodiscard]] std::optional<std::uint64_t> whole_number(std::string_view key) const;
  [[nodiscard]] std::optional<bool> truth(std::string_view key) const;
  /// A text of at most `most` bytes that is not empty and has no line break or other control character.
  [[nodiscard]] std::optional<std::string> text(std::string_view key, std::size_t most = kLongestText) const;
  /// Three finite numbers, each within `range`.
  [[nodiscard]] std::optional<Vec3> vector(std::string_view key, const Range& range = kAnyNumber) const;
  /// A list of finite numbers, each within `range`; not empty.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key,
                                                           const Range& range = kAnyNumber) const;
  /// A list of lists of numbers, as numbers().
  [[nodiscard]] std::optional<std::vector<std::vector<double>>> number_lists(
      std::string_view key, const Range& range = kAnyNumber) const;
  /// A list of texts, as text(); not empty.
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key) const;
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key) const;
  /// A table, or an array of tables; empty when the key is missing.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;

  /// @throws InputError "FILE:LINE: field = value: want", with the key's line.
  [[noreturn]] void fail(std::string_view key, const std::string& want) const;
  /// @throws InputError "FILE:LINE: field: missing, want", with the table's line.
  [[noreturn]] void fail_missing(std::string_view key, const std::string& want) const;

  /// "FILE:LINE" of a key, or of the table when the key is missing; "FILE with --set" for a key that a
  /// Setting added.
  [[nodiscard]] std::string location(std::string_view key) const;
  /// The key with its table's path, "tool.jaw.pivot_mm".
  [[nodiscard]] std::string field(std::string_view key) const;
  /// @throws InputError for a ParameterError about a field of this table (dotted for a table inside it), with
  /// that field's line and its value in the file.
  [[noreturn]] void fail(const ParameterError& error) const;

 private:
  [[noreturn]] void fail_path(std::string_view dotted, const std::string& want) const;
  [[nodiscard]] TomlTable child(std::string_view key, const toml::node& node) const;

  std::string file_;
  std::string field_;
  const toml::table* table_;
  int line_;
};

}  // namespace palpate::scene
