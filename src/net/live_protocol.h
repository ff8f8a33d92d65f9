#pragma once
// Commands of clients of the live interface (docs/live-interface.md): one JSON object per message.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/geometry/ray.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/parameter_updates.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/tissue.h"

namespace palpate::net {

/// Version of the protocol. It changes when clients of the previous version no longer work.
inline constexpr const char* kLiveProtocol = "1";

inline constexpr std::size_t kLargestRequest = 16384;  // bytes
inline constexpr double kFastestStream = 1000.0;       // Hz

/// Why a command failed: a code for programs, a message for users, and the invalid field if there is one.
class LiveError final : public InputError {
 public:
  LiveError(std::string code, const std::string& message, std::string field = "")
      : InputError(message), code_(std::move(code)), field_(std::move(field)) {}
  /// json, command, field, hello, version, token, full, rate, state or refused (docs/live-interface.md).
  [[nodiscard]] const std::string& code() const noexcept { return code_; }
  [[nodiscard]] const std::string& field() const noexcept { return field_; }

 private:
  std::string code_;
  std::string field_;
};

/// Changes to a tissue; values that are not set stay.
struct TissueEdit {
  std::optional<std::string> preset;  // applied first
  std::optional<std::string> name;
  std::optional<model::LawKind> law;
  std::optional<model::RelaxationTerms> relaxation;                                  // all terms; SI
  std::vector<std::pair<const model::TissueField*, std::optional<double>>> numbers;  // SI; none: the default
};

/// Changes to the touch noise; values that are not set stay.
struct NoiseEdit {
  std::optional<bool> enabled;
  std::optional<double> gain;            // K [N m]
  std::optional<double> threshold;       // d0 [m]
  std::optional<double> user_threshold;  // N; with `share` it replaces the gain
  std::optional<double> share;
};

/// Changes to an inclusion, which its name or its number selects; values that are not set stay.
struct InclusionEdit {
  std::optional<std::string> name;
  std::optional<std::uint32_t> number;  // from 1, in the scene's order
  std::optional<Vec3> centre_S;         // organ frame [m]
  std::optional<double> ratio;          // stiffness ratio
};

// The commands: texts unchanged, numbers in SI.
struct Hello {
  std::string token;
};
struct GetVersion {};
struct GetState {};
struct GetScene {};
struct GetSurface {
  bool at_rest = false;  // the organ at rest; else only the moved vertices
};
struct GetTool {
  std::uint32_t hand = 0;
};
struct GetPicture {};
struct Stream {
  double rate_Hz = 0.0;  // 0: ends the stream
};
struct Load {
  std::optional<std::string> scene;  // a file below the server's folder; none: the built-in press or pull
  std::optional<std::string> task;
  std::optional<std::string> organ;
  std::optional<std::string> organ_unit;
  std::vector<std::string> inclusions;  // presets, or none
  std::optional<std::string> tissue;
  std::optional<std::string> tool;
  std::optional<std::string> tool_unit;
  std::optional<std::string> device;  // a kind alone
  std::optional<double> rate_Hz;
  std::optional<std::uint64_t> seed;
  bool no_noise = false;
};
struct GetDevices {};
struct Start {
  std::optional<std::string> device;  // replaces the scene's
};
struct Stop {};
struct Record {
  bool on = false;
};
/// Input of a hand whose device is a mouse; values that are not set stay.
struct SteerMouse {
  std::uint32_t hand = 0;
  std::optional<geometry::Ray> ray_W;  // the pointer's line of sight
  bool elsewhere = false;              // the pointer is not over the picture
  double deeper = 0.0;                 // m, added to the set depth
  std::optional<bool> grip;            // the button of the jaws is held
  std::optional<bool> park;
};
/// State of the gamepad of a hand, which a page sends several times a second.
struct SteerGamepad {
  std::uint32_t hand = 0;
  Vec3 way_W = Vec3::Zero();  // where the sticks lead the tool, by their deflection
  double press = 0.0;         // of the trigger that presses, 0 to 1
  double close = 0.0;         // of the trigger that closes the jaws, 0 to 1
  std::uint32_t buttons = 0;  // one bit per button
};
struct SetTissue {
  TissueEdit edit;
};
struct SetNoise {
  NoiseEdit edit;
};
struct SetInclusion {
  InclusionEdit edit;
};
struct ResetFaults {};

using LiveCommand = std::variant<Hello, GetVersion, GetState, GetScene, GetSurface, GetTool, GetPicture,
                                 GetDevices, Stream, Load, Start, Stop, Record, SteerMouse, SteerGamepad,
                                 SetTissue, SetNoise, SetInclusion, ResetFaults>;

/// The message that an answer belongs to.
struct LiveReference {
  std::string command;  // value of "do"; empty: unknown
  std::string id;       // as JSON; empty: none was given
};

struct LiveRequest {
  LiveReference reference;
  LiveCommand command;
};

/// [any] Reads a message; not for the tick. @param reference command and id, set also when the message is
/// invalid
/// @throws LiveError naming the field, its value and the valid values.
[[nodiscard]] LiveCommand read_live_message(std::string_view text, LiveReference& reference);

/// [setup] Applies changes to a tissue, without model::validate(). @throws InputError for an unknown preset.
[[nodiscard]] model::TissueParameters edited(model::TissueParameters tissue, const TissueEdit& edit);

/// [setup] Applies changes to the touch noise. @throws ParameterError for an invalid threshold or share.
[[nodiscard]] haptics::LiveNoise edited(haptics::LiveNoise noise, const NoiseEdit& edit);

// Clients see only visible inclusions, so that a hidden lump stays to be found.

/// [any] A visible inclusion with the keys of a scene file. @param index in the scene, from 0
[[nodiscard]] nlohmann::ordered_json inclusion_json(const scene::InclusionSetup& inclusion,
                                                    std::size_t index);

/// {"inclusions": the visible ones, "hidden_inclusions": the number of the others}.
[[nodiscard]] nlohmann::ordered_json inclusions_json(const std::vector<scene::InclusionSetup>& inclusions);

/// The index of the visible inclusion that a client selects. @throws LiveError that lists the visible ones
[[nodiscard]] std::size_t find_inclusion(const std::vector<scene::InclusionSetup>& inclusions,
                                         const InclusionEdit& edit);

/// Applies changes to an inclusion, without model::validate().
[[nodiscard]] scene::InclusionSetup edited(scene::InclusionSetup inclusion, const InclusionEdit& edit);

}  // namespace palpate::net
