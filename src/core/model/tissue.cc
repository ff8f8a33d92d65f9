#include "palpate/tissue.h"

#include <cmath>
#include <utility>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/model/layer_fields.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::model {
namespace {

[[noreturn]] void refuse_terms(std::size_t count) {
  throw ParameterError("relaxation", static_cast<double>(count),
                       "at most " + std::to_string(kMaxRelaxationTerms) + " terms");
}

void require_positive(const std::string& field, double value) {
  if (!kPositive.contains(value)) throw ParameterError(field, value, kPositive.to_string());
}

// The parameters of one preset; all others have their defaults.
struct Preset {
  const char* name;
  double k1_N_per_m;
  double beta;
  double q;
  double press_limit_mm;  // L_1
  double pull_limit_mm;
  double rest_length_mm;
  double t1_us;
  double max_depth_mm;
  LawKind law;
  const char* indenter = nullptr;  // of the measurement; null: illustrative
  double radius_mm = 0.0;          // of the indenter
};

// Sources of all values: docs/tissues.md. k1 and beta of gallbladder and heart are the paper's, and so is
// their law.
constexpr std::array kPresets{
    Preset{"gallbladder", 18.0, 1.6, 0.7, 8.0, 8.0, 14.0, 1.0, 15.0, LawKind::kLayered},
    Preset{"heart", 15.0, 2.0, 0.7, 8.0, 8.0, 14.0, 1.0, 15.0, LawKind::kLayered},
    Preset{"liver", 25.0, 2.5, 0.7, 8.0, 8.0, 16.0, 1.0, 15.0, LawKind::kSmooth},
    Preset{"kidney", 40.0, 3.5, 0.7, 7.5, 7.5, 15.0, 1.0, 14.5, LawKind::kSmooth},
    Preset{"liver-ex-vivo", 88.96, 6.781, 2.321, 0.8312, 0.8312, 1.6624, 1.0, 2.5, LawKind::kSmooth,
           "ball, 73 robotic probes at 3 places of pig liver ex vivo on a hard table; 5 to 95 % of the "
           "probes at 2.5 mm: 0.20 to 2.07 N",
           4.0},
    Preset{"heart-muscle", 152.1, 20.0, 0.425, 0.7074, 1.084, 2.168, 1.0, 1.0, LawKind::kSmooth,
           "two plates, cubes of heart muscle of 7.1 to 10.9 mm, 5 specimens in 3 axes, pressed and pulled; "
           "5 to 95 % of the curves at 1 mm: 0.10 to 0.64 N pressed, 0.05 to 0.61 N pulled",
           5.3},
    Preset{"skin-fat-muscle", 95.0, 1.6, 0.7, 8.0, 8.0, 14.0, 1.0, 15.0, LawKind::kSmooth},
    Preset{"liver-capsule", 80.0, 1.6, 0.7, 8.0, 8.0, 14.0, 1.0, 15.0, LawKind::kSmooth},
    Preset{"vein", 80.0, 1.6, 0.7, 6.0, 6.0, 14.0, 1.0, 12.0, LawKind::kSmooth},
    Preset{"epidural", 120.0, 1.6, 0.7, 8.0, 8.0, 14.0, 1.0, 15.0, LawKind::kSmooth},
};

// Layers of the presets that a needle enters; illustrative, of the order of the measurements in
// docs/needle.md. The last layer of each has no end.
struct PresetLayer {
  const char* tissue;
  const char* name;
  double thickness_mm;  // 0: no end
  double puncture_force_N;
  double cutting_force_N;
  double friction_N;
  double friction_N_per_mm;
  double lateral_N_per_mm2;
};

constexpr std::array kPresetLayers{
    PresetLayer{"skin-fat-muscle", "skin", 2.0, 4.7, 1.2, 0.1, 0.13, 0.02},
    PresetLayer{"skin-fat-muscle", "fat", 6.0, 0.0, 0.2, 0.0, 0.01, 0.005},
    PresetLayer{"skin-fat-muscle", "muscle", 0.0, 3.1, 0.6, 0.1, 0.07, 0.02},
    PresetLayer{"liver-capsule", "capsule", 0.5, 1.6, 0.5, 0.05, 0.02, 0.01},
    PresetLayer{"liver-capsule", "parenchyma", 0.0, 0.0, 0.35, 0.05, 0.012, 0.01},
    PresetLayer{"vein", "skin", 1.5, 1.9, 0.5, 0.05, 0.03, 0.02},
    PresetLayer{"vein", "fat", 2.0, 0.0, 0.15, 0.0, 0.01, 0.005},
    PresetLayer{"vein", "wall", 0.6, 1.0, 0.4, 0.05, 0.02, 0.01},
    PresetLayer{"vein", "lumen", 4.0, 0.0, 0.02, 0.0, 0.0, 0.0},
    PresetLayer{"vein", "far wall", 0.6, 1.0, 0.4, 0.05, 0.02, 0.01},
    PresetLayer{"vein", "muscle", 0.0, 0.8, 0.4, 0.05, 0.02, 0.02},
    PresetLayer{"epidural", "skin", 3.0, 6.0, 2.0, 0.2, 0.06, 0.02},
    PresetLayer{"epidural", "fat", 8.0, 0.0, 0.6, 0.0, 0.02, 0.005},
    PresetLayer{"epidural", "supraspinous ligament", 4.0, 5.0, 2.6, 0.1, 0.05, 0.03},
    PresetLayer{"epidural", "interspinous ligament", 18.0, 0.0, 2.0, 0.0, 0.04, 0.03},
    PresetLayer{"epidural", "ligamentum flavum", 4.0, 6.5, 4.0, 0.1, 0.06, 0.03},
    PresetLayer{"epidural", "epidural space", 5.0, 0.0, 0.1, 0.0, 0.005, 0.002},
    PresetLayer{"epidural", "dura", 0.4, 2.2, 0.6, 0.05, 0.02, 0.01},
    PresetLayer{"epidural", "spinal fluid", 0.0, 0.0, 0.02, 0.0, 0.0, 0.0},
};

constexpr double kPointedTip =
    3.0;  // friction of tissues for needles, whose tip does not slide before it enters

std::vector<TissueLayer> preset_layers(std::string_view tissue) {
  std::vector<TissueLayer> layers;
  for (const PresetLayer& preset : kPresetLayers) {
    if (preset.tissue != tissue) continue;
    TissueLayer layer;
    layer.name = preset.name;
    if (preset.thickness_mm > 0.0) layer.thickness = preset.thickness_mm * kMillimetre;
    layer.puncture_force = preset.puncture_force_N;
    layer.cutting_force = preset.cutting_force_N;
    layer.friction = preset.friction_N;
    layer.friction_per_length = preset.friction_N_per_mm / kMillimetre;
    layer.lateral_stiffness = preset.lateral_N_per_mm2 / (kMillimetre * kMillimetre);
    layers.push_back(std::move(layer));
  }
  return layers;
}

}  // namespace

const char* to_string(LawKind law) noexcept { return law == LawKind::kSmooth ? "smooth" : "layered"; }

LawKind parse_law(std::string_view text) {
  if (text == "layered") return LawKind::kLayered;
  if (text == "smooth") return LawKind::kSmooth;
  throw InputError("law = \"" + std::string(text) + "\": must be layered or smooth");
}

void RelaxationTerms::push_back(const RelaxationTerm& term) {
  if (count_ == kMaxRelaxationTerms) refuse_terms(count_ + 1);
  terms_[count_++] = term;
}

double TissueNumbers::first_limit(Direction direction) const noexcept {
  const double limit = direction == Direction::kPull ? max_length - rest_length : rest_length - min_length;
  // Rounds to a femtometre, so that 22 mm - 14 mm is 8 mm and not 7.999999999999998 mm.
  constexpr double kPerMetre = 1e15;
  const double rounded = std::floor(limit * kPerMetre + 0.5) / kPerMetre;
  return rounded > 0.0 && std::isfinite(rounded) ? rounded : limit;
}

double TissueNumbers::tangential_stiffness() const noexcept {
  constexpr double kOfFirstSpring =
      10.0;  // reaches the friction cone within 0.6 mm of travel (docs/model.md, section 4)
  return contact.tangential_stiffness.value_or(kOfFirstSpring * k1);
}

void validate_layers(const std::vector<TissueLayer>& layers) {
  if (layers.size() > kMaxTissueLayers) {
    throw ParameterError("layer", static_cast<double>(layers.size()),
                         "at most " + std::to_string(kMaxTissueLayers) + " layers");
  }
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string path = "layer " + std::to_string(i + 1) + ": ";
    for (std::size_t k = 0; k < i && !layers[i].name.empty(); ++k) {
      if (layers[k].name != layers[i].name) continue;
      throw InputError(path + "name = \"" + layers[i].name + "\": layer " + std::to_string(k + 1) +
                       " has this name too");
    }
    const double thickness = layers[i].thickness / kMillimetre;
    if (i + 1 == layers.size()) {
      if (thickness != std::numeric_limits<double>::infinity()) {
        throw ParameterError(path + kLayerThicknessKey, thickness, "left out: the last layer has no end");
      }
    } else if (!kLayerThicknessRange.contains(thickness)) {
      throw ParameterError(path + kLayerThicknessKey, thickness, kLayerThicknessRange.to_string());
    }
    for (const LayerField& field : kLayerFields) {
      const double value = layers[i].*field.at / field.unit.si;
      if (!field.range.contains(value))
        throw ParameterError(path + field.key, value, field.range.to_string());
    }
  }
}

void validate(const TissueParameters& tissue) {
  if (tissue.law > LawKind::kSmooth) {
    throw ParameterError("law", static_cast<double>(tissue.law), "0 (layered) or 1 (smooth)");
  }
  for (const TissueField& field : kTissueFields) field.check(tissue);
  // Contacts with smaller patches step from one point of the tool to the next.
  constexpr double kSmallestReference = 1e-3;  // m
  if (tissue.contact.reference_radius < kSmallestReference) {
    throw ParameterError("contact.reference_radius_mm", tissue.contact.reference_radius / kMillimetre,
                         "finite and >= 1");
  }
  validate_relaxation(tissue.relaxation);
  validate_layers(tissue.layers);
  if (tissue.size_exponent != 0.0 && !tissue.source) {
    throw ParameterError("size_exponent", tissue.size_exponent,
                         "0 where [tissue.source] has no radius_mm that a tool's size can be compared with");
  }
  if (tissue.source) require_positive("source.radius_mm", tissue.source->radius / kMillimetre);
}

double size_factor(double size_exponent, double source_radius, double tip_radius) noexcept {
  return size_exponent == 0.0 ? 1.0
                              : portable::exp(size_exponent * portable::log(tip_radius / source_radius));
}

TissueParameters for_tool(TissueParameters tissue, double tip_radius) {
  if (tissue.size_exponent == 0.0) return tissue;
  tissue.k1 *= size_factor(tissue.size_exponent, tissue.source->radius, tip_radius);
  tissue.size_exponent = 0.0;
  return tissue;
}

void validate_relaxation(std::span<const RelaxationTerm> terms) {
  if (terms.size() > kMaxRelaxationTerms) refuse_terms(terms.size());
  double sum = 0.0;
  for (const RelaxationTerm& term : terms) {
    require_positive("relaxation.share", term.g);
    require_positive("relaxation.time_s", term.tau);
    sum += term.g;
  }
  if (!(sum < 1.0)) {
    throw ParameterError("relaxation.share", sum,
                         "< 1 in sum, so that some force remains after full relaxation");
  }
}

std::span<const char* const> tissue_preset_names() noexcept {
  static constexpr auto kNames = [] {
    std::array<const char*, kPresets.size()> names{};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kPresets[i].name;
    return names;
  }();
  return kNames;
}

TissueParameters tissue_preset(const std::string& name) {
  std::string known;
  for (const Preset& preset : kPresets) {
    if (name == preset.name) {
      TissueParameters tissue;
      tissue.name = name;
      tissue.k1 = preset.k1_N_per_m;
      tissue.beta = preset.beta;
      tissue.q = preset.q;
      tissue.rest_length = preset.rest_length_mm * kMillimetre;
      tissue.max_length = (preset.rest_length_mm + preset.pull_limit_mm) * kMillimetre;
      tissue.min_length = (preset.rest_length_mm - preset.press_limit_mm) * kMillimetre;
      tissue.t1 = preset.t1_us * kMicrosecond;
      tissue.max_depth = preset.max_depth_mm * kMillimetre;
      tissue.law = preset.law;
      if (preset.indenter != nullptr) {
        tissue.source = SourceParameters{preset.indenter, preset.radius_mm * kMillimetre};
      }
      tissue.layers = preset_layers(preset.name);
      if (!tissue.layers.empty()) tissue.contact.friction = kPointedTip;
      return tissue;
    }
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  const auto presets = tissue_preset_names();
  const std::string near = nearest_word(name, std::vector<std::string>(presets.begin(), presets.end()));
  throw InputError("tissue = \"" + excerpt(name) + "\": no built-in tissue of that name; there are " + known +
                   (near.empty() ? "" : "; did you mean " + near + "?"));
}

}  // namespace palpate::model
