#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/model/layer_fields.h"
#include "core/model/tissue_fields.h"
#include "io/scene/names.h"
#include "io/scene/toml_reader.h"
#include "io/system/file_content.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

model::LawKind read_law(const TomlTable& table) {
  const std::string law = table.text("law").value_or("layered");
  if (law == model::to_string(model::LawKind::kSmooth)) return model::LawKind::kSmooth;
  if (law != model::to_string(model::LawKind::kLayered)) {
    table.fail("law", "must be \"layered\" or \"smooth\"");
  }
  return model::LawKind::kLayered;
}

model::RelaxationTerms read_relaxation(const TomlTable& table) {
  model::RelaxationTerms terms;
  double sum = 0.0;
  for (const TomlTable& entry : table.tables("relaxation")) {
    entry.allow_only({"share", "time_s"});
    model::RelaxationTerm term;
    term.g = entry.required_number("share", kPositive);
    term.tau = entry.required_number("time_s", kPositive);
    sum += term.g;
    if (!(sum < 1.0)) {
      entry.fail("share", "the shares of all terms must sum to less than 1, these to " + shortest(sum));
    }
    if (terms.size() == model::kMaxRelaxationTerms) {
      entry.fail("share", "one term too many, must be at most " + std::to_string(model::kMaxRelaxationTerms) +
                              " [[tissue.relaxation]]");
    }
    terms.push_back(term);
  }
  return terms;
}

std::vector<model::TissueLayer> read_layers(const TomlTable& table) {
  std::vector<model::TissueLayer> layers;
  const std::vector<TomlTable> entries = table.tables("layer");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const TomlTable& entry = entries[i];
    std::vector<std::string> keys{"name", model::kLayerThicknessKey};
    for (const model::LayerField& field : model::kLayerFields) keys.emplace_back(field.key);
    entry.allow_only(keys);
    if (i == model::kMaxTissueLayers) {
      entry.fail("name", "one layer too many, must be at most " + std::to_string(model::kMaxTissueLayers) +
                             " [[tissue.layer]]");
    }
    model::TissueLayer layer;
    layer.name = entry.text("name", kLongestName).value_or("layer " + std::to_string(i + 1));
    for (std::size_t k = 0; k < i; ++k) {
      if (layers[k].name == layer.name) entry.fail("name", fmt::format("layer {} has this name too", k + 1));
    }
    const auto checked = [&entry](const char* key, const model::FieldRange& range, double value) {
      if (!range.contains(value)) entry.fail(key, "must be " + range.to_string());
      return value;
    };
    if (i + 1 < entries.size()) {
      const double thickness = entry.required_number(model::kLayerThicknessKey);
      layer.thickness =
          checked(model::kLayerThicknessKey, model::kLayerThicknessRange, thickness) * kMillimetre;
    } else if (entry.number(model::kLayerThicknessKey)) {
      entry.fail(model::kLayerThicknessKey, "the last layer has no end: leave it out, or add a layer below");
    }
    for (const model::LayerField& field : model::kLayerFields) {
      const std::optional<double> value =
          field.required ? entry.required_number(field.key) : entry.number(field.key);
      layer.*field.at = checked(field.key, field.range, value.value_or(0.0)) * field.unit.si;
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

std::vector<std::string> keys_of(std::string_view section) {
  std::vector<std::string> keys;
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.section == section) keys.emplace_back(field.key);
  }
  return keys;
}

/// The numbers of [tissue] itself, or of a table inside it.
void read_numbers(const TomlTable& table, std::string_view section, model::TissueNumbers& tissue) {
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.section != section) continue;
    const std::optional<double> value =
        field.required() ? table.required_number(field.key) : table.number(field.key);
    if (value) field.at.set(tissue, *value * field.unit.si);
  }
}

/// The indenter, which a table with numbers alone does not have.
std::optional<model::SourceParameters> read_source(const TomlTable& table,
                                                   const model::TissueNumbers& tissue) {
  if (tissue.max_depth && !table.text("indenter") && !table.number("radius_mm")) return std::nullopt;
  model::SourceParameters source;
  source.indenter = table.text("indenter", kLongestName).value_or("");
  source.radius = table.required_number("radius_mm", kPositive) * kMillimetre;
  return source;
}

model::TissueParameters read_parameters(const TomlTable& table, const std::string& default_name) {
  model::TissueParameters tissue;
  std::vector<std::string> keys = keys_of("");
  keys.insert(keys.end(), {"name", "law", "relaxation", "layer"});
  for (const model::TissueSection& section : model::kTissueSections) keys.emplace_back(section.key);
  table.allow_only(keys);
  tissue.name = table.text("name", kLongestName).value_or(default_name);
  tissue.law = read_law(table);
  read_numbers(table, "", tissue);
  tissue.relaxation = read_relaxation(table);
  tissue.layers = read_layers(table);
  for (const model::TissueSection& section : model::kTissueSections) {
    const std::optional<TomlTable> below = table.table(section.key);
    if (!below) continue;
    std::vector<std::string> allowed = keys_of(section.key);
    const bool is_source = section.key == model::kSourceSection;
    if (is_source) allowed.insert(allowed.begin(), {"indenter", "radius_mm"});
    below->allow_only(allowed);
    read_numbers(*below, section.key, tissue);
    if (is_source) tissue.source = read_source(*below, tissue);
  }
  return tissue;
}

model::TissueParameters parse_tissue_file(const std::filesystem::path& file) {
  const TomlFile toml = read_toml(file);
  const TomlTable root(toml);
  root.allow_only({"tissue"});
  const std::optional<TomlTable> table = root.table("tissue");
  if (!table) root.fail_missing("tissue", "a tissue file must have a table [tissue]");
  model::TissueParameters tissue = read_parameters(*table, to_text(file.stem()));
  try {
    model::validate(tissue);
  } catch (const ParameterError& error) {
    table->fail(error);
  }
  return tissue;
}

std::string real(double value) {
  const std::string text = shortest(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

model::TissueParameters read_tissue_file(const std::filesystem::path& file) {
  try {
    return parse_tissue_file(file);
  } catch (const InputError&) {
    refuse_other_content(file, FileContent::kTissue, "a tissue file");
    throw;
  }
}

std::string to_toml(const model::TissueParameters& tissue) {
  std::string out =
      "[tissue]\nname = " + quoted(tissue.name) + "\nlaw = " + quoted(model::to_string(tissue.law)) + "\n";
  const auto line = [&out](const char* key, const std::string& value) {
    out += std::string(key) + " = " + value + "\n";
  };
  const auto numbers = [&](std::string_view section) {
    for (const model::TissueField& field : model::kTissueFields) {
      const std::optional<double> value = field.at.get(tissue);
      if (field.section == section && value) line(field.key, real(*value / field.unit.si));
    }
  };
  numbers("");
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    out += "[[tissue.relaxation]]\n";
    line("share", real(term.g));
    line("time_s", real(term.tau));
  }
  for (const model::TissueLayer& layer : tissue.layers) {
    out += "[[tissue.layer]]\n";
    line("name", quoted(layer.name));
    if (std::isfinite(layer.thickness)) line(model::kLayerThicknessKey, real(layer.thickness / kMillimetre));
    for (const model::LayerField& field : model::kLayerFields) {
      if (field.required || layer.*field.at != 0.0) line(field.key, real(layer.*field.at / field.unit.si));
    }
  }
  for (const model::TissueSection& section : model::kTissueSections) {
    const bool is_source = section.key == model::kSourceSection;
    if (is_source && !tissue.source && !tissue.max_depth) continue;
    out += "[tissue." + std::string(section.key) + "]\n";
    if (is_source && tissue.source) {
      if (!tissue.source->indenter.empty()) line("indenter", quoted(tissue.source->indenter));
      line("radius_mm", real(tissue.source->radius / kMillimetre));
    }
    numbers(section.key);
  }
  return out;
}

model::TissueParameters load_tissue(const std::string& name_or_file) {
  if (is_path(name_or_file)) return read_tissue_file(to_path(name_or_file));
  return model::tissue_preset(name_or_file);
}

}  // namespace palpate::scene
