#include "fit/identify/fit_fields.h"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/text.h"

namespace palpate::identify {
namespace {

/// A value for readers; "" for lists, which have no position.
template <typename Value>
std::string shown_value(const Value& value, [[maybe_unused]] bool as_percent) {
  if constexpr (std::floating_point<Value>) return as_percent ? percent(value) : brief(value);
  if constexpr (std::integral<Value>) return std::to_string(value);
  if constexpr (std::same_as<Value, std::string>) return value;
  if constexpr (std::same_as<Value, model::LawKind>) return model::to_string(value);
  return "";
}

template <typename Fit>
std::vector<ShownField> shown(const Fit& fit) {
  std::vector<ShownField> fields;
  for_each_field(fit, [&fields](const ResultField& field, const auto& value) {
    if (field.place > 0) fields.push_back({field, shown_value(value, field.as_percent)});
  });
  std::stable_sort(fields.begin(), fields.end(),
                   [](const ShownField& a, const ShownField& b) { return a.field.place < b.field.place; });
  return fields;
}

template <typename Fit>
std::string summary(const Fit& fit) {
  std::string text;
  for (const ShownField& one : shown(fit)) {
    if (one.field.phrase != nullptr) text += fmt::format(fmt::runtime(one.field.phrase), one.text);
  }
  return text;
}

}  // namespace

std::vector<ShownField> shown_fields(const SpecimenFit& fit) { return shown(fit); }
std::string summary_of(const SpecimenFit& fit) { return summary(fit); }
std::string summary_of(const PooledFit& fit) { return summary(fit); }

}  // namespace palpate::identify
