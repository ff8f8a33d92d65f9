#include "io/scene/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/system/input_file.h"
#include "io/system/nesting.h"
#include "io/system/path_text.h"

namespace palpate::scene {
namespace {

constexpr std::size_t kLongestExcerpt = 80;  // bytes of a key or value in a message

std::string value_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return shortest(number->get());
  if (const auto* text = node.as_string()) return "\"" + excerpt(text->get(), kLongestExcerpt) + "\"";
  std::ostringstream out;
  node.visit([&out](const auto& n) { out << n; });
  return excerpt(out.str(), kLongestExcerpt);
}

std::optional<double> as_number(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  return std::nullopt;
}

std::optional<double> as_number_in(const toml::node& node, const Range& range) {
  const std::optional<double> value = as_number(node);
  return value && std::isfinite(*value) && range.contains(*value) ? value : std::nullopt;
}

std::optional<std::vector<double>> as_numbers(const toml::node& node, const Range& range) {
  const auto* array = node.as_array();
  if (array == nullptr || array->empty()) return std::nullopt;
  std::vector<double> values;
  for (const toml::node& entry : *array) {
    const std::optional<double> value = as_number_in(entry, range);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<std::string> as_line(const toml::node& node, std::size_t most = kLongestText) {
  const auto* value = node.as_string();
  if (value == nullptr || value->get().empty() || value->get().size() > most) return std::nullopt;
  if (value->get() != one_line(value->get())) return std::nullopt;
  return value->get();
}

/// The valid key that the user probably meant: one that continues `word` (a missing unit), else the nearest
/// by spelling.
std::string nearest_key(std::string_view word, const std::vector<std::string>& known) {
  const std::string start = std::string(word) + "_";
  const auto longer =
      std::find_if(known.begin(), known.end(), [&](const auto& key) { return key.starts_with(start); });
  return longer != known.end() ? *longer : nearest_word(word, known);
}

}  // namespace

std::string Range::to_string() const {
  if (std::isfinite(low) && std::isfinite(high)) {
    return fmt::format("a number {}{} and <= {}", low_excluded ? "> " : ">= ", shortest(low), shortest(high));
  }
  if (std::isfinite(low))
    return std::string("a finite number ") + (low_excluded ? "> " : ">= ") + shortest(low);
  return "a finite number";
}

TomlFile read_toml(const std::filesystem::path& file) {
  return parse_toml(InputFile(file, kTomlInput).read_rest(), to_text(file));
}

TomlFile parse_toml(const std::string& text, const std::string& name) {
  if (text.size() > kTomlInput.max_bytes) {
    throw InputError(fmt::format("{}: has {} bytes, must be a TOML text of at most {}", name, text.size(),
                                 kTomlInput.max_bytes));
  }
  if (const auto deep = toml_nested_deeper_at(text, kMaxNesting)) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*deep), '\n');
    throw InputError(
        fmt::format("{}:{}: nested deeper than {} levels, must be at most that; each part of a "
                    "dotted key is a level",
                    name, line, kMaxNesting));
  }
  try {
    return {name, toml::parse(text, name)};
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: not valid TOML: {}", name, error.source().begin.line,
                                 excerpt(error.description(), 4 * kLongestExcerpt)));
  }
}

TomlTable::TomlTable(std::string file, std::string field, const toml::table& table, int line)
    : file_(std::move(file)), field_(std::move(field)), table_(&table), line_(line) {}

std::string TomlTable::field(std::string_view key) const {
  return field_.empty() ? std::string(key) : field_ + "." + std::string(key);
}

std::string TomlTable::location(std::string_view key) const {
  const toml::node* node = table_->get(key);
  const auto line = node == nullptr ? static_cast<unsigned>(line_) : node->source().begin.line;
  return line > 0 ? fmt::format("{}:{}", file_, line) : file_ + " with --set";
}

void TomlTable::fail(std::string_view key, const std::string& want) const {
  const toml::node* node = table_->get(key);
  const std::string value = node == nullptr ? "" : " = " + value_text(*node);
  throw InputError(fmt::format("{}: {}{}: {}", location(key), field(key), value, want));
}

void TomlTable::fail_missing(std::string_view key, const std::string& want) const {
  throw InputError(fmt::format("{}: {}: missing, {}", location(key), field(key), want));
}

void TomlTable::fail(const ParameterError& error) const {
  const std::string message = error.what();  // "field = value: must be ..."
  const std::size_t colon = message.find(": ");
  fail_path(error.field(), colon == std::string::npos ? message : message.substr(colon + 2));
}

void TomlTable::fail_path(std::string_view dotted, const std::string& want) const {
  const std::size_t dot = dotted.find('.');
  if (dot == std::string_view::npos) fail(dotted, want);
  const std::string_view key = dotted.substr(0, dot);
  const toml::node* node = table_->get(key);
  if (node == nullptr || !node->is_table()) fail(dotted, want);
  child(key, *node).fail_path(dotted.substr(dot + 1), want);
}

TomlTable TomlTable::child(std::string_view key, const toml::node& node) const {
  return {file_, field(key), *node.as_table(), static_cast<int>(node.source().begin.line)};
}

std::optional<double> TomlTable::number(std::string_view key, const Range& range) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<double> value = as_number_in(*node, range);
  if (!value) fail(key, "must be " + range.to_string());
  return value;
}

double TomlTable::required_number(std::string_view key, const Range& range) const {
  const std::optional<double> value = number(key, range);
  if (!value) fail_missing(key, "must be " + range.to_string());
  return *value;
}

std::optional<std::uint64_t> TomlTable::whole_number(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_integer();
  if (value == nullptr || value->get() < 0) fail(key, "must be a whole number >= 0");
  return static_cast<std::uint64_t>(value->get());
}

std::optional<bool> TomlTable::truth(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_boolean();
  if (value == nullptr) fail(key, "must be true or false");
  return value->get();
}

std::optional<std::string> TomlTable::text(std::string_view key, std::size_t most) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  std::optional<std::string> value = as_line(*node, most);
  if (!value)
    fail(key, fmt::format("must be a text in quotes, not empty, on one line, of at most {} bytes", most));
  return value;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, const Range& range) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  std::optional<std::vector<double>> values = as_numbers(*node, range);
  if (!values) fail(key, "must be a list of numbers [a, b, ...], each " + range.to_string());
  return values;
}

std::optional<std::vector<std::vector<double>>> TomlTable::number_lists(std::string_view key,
                                                                        const Range& range) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const std::string want =
      "must be a list of lists of numbers [[a, ...], [b, ...]], each " + range.to_string();
  const auto* array = node->as_array();
  if (array == nullptr) fail(key, want);
  std::vector<std::vector<double>> lists;
  for (const toml::node& entry : *array) {
    std::optional<std::vector<double>> values = as_numbers(entry, range);
    if (!values) fail(key, want);
    lists.push_back(std::move(*values));
  }
  return lists;
}

std::optional<std::vector<std::string>> TomlTable::texts(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const std::string want = "must be a list of texts [\"a\", \"b\", ...], each not empty, on one line";
  const auto* array = node->as_array();
  if (array == nullptr || array->empty()) fail(key, want);
  std::vector<std::string> values;
  for (const toml::node& entry : *array) {
    std::optional<std::string> value = as_line(entry);
    if (!value) fail(key, want);
    values.push_back(std::move(*value));
  }
  return values;
}

std::optional<Vec3> TomlTable::vector(std::string_view key, const Range& range) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const std::string want = "must be three numbers [x, y, z], each " + range.to_string();
  const std::optional<std::vector<double>> values = as_numbers(*node, range);
  if (!values || values->size() != 3) fail(key, want);
  return Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) fail(key, "must be a table, [" + field(key) + "] or { ... }");
  return child(key, *node);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> found;
  const toml::node* node = table_->get(key);
  if (node == nullptr) return found;
  const std::string want = "must be a table or an array of tables, [[" + field(key) + "]]";
  if (node->is_table()) {
    found.push_back(child(key, *node));
    return found;
  }
  const auto* array = node->as_array();
  if (array == nullptr) fail(key, want);
  for (const toml::node& entry : *array) {
    if (!entry.is_table()) fail(key, want);
    found.push_back(child(key, entry));
  }
  return found;
}

void TomlTable::allow_only(const std::vector<std::string>& known) const {
  for (const auto& [key, node] : *table_) {
    const std::string_view name = key.str();
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_key(name, known);
    const std::string hint = near.empty() ? "valid are " + alternatives(known)
                                          : "did you mean " + near + other_unit(name, near) + "?";
    throw InputError(fmt::format("{}:{}: {} = {}: unknown key, {}", file_, key.source().begin.line,
                                 field(excerpt(name, kLongestExcerpt)), value_text(node), hint));
  }
}

}  // namespace palpate::scene
