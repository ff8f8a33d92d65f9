#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/model/tissue_fields.h"
#include "palpate/error.h"
#include "palpate/parameter_updates.h"
#include "palpate/tissue.h"

// What a client of the live interface may ask (docs/live-interface.md): one JSON object a message.
namespace palpate::net {

/// The protocol's version. It is another one when a client of the one before would no longer be understood.
inline constexpr const char* kLiveProtocol = "1";

inline constexpr std::size_t kLargestRequest = 16384;  // bytes
inline constexpr double kFastestStream = 1000.0;       // Hz

/// Why a message was not done: a code for programs, words for people, and the field where one is at fault.
class LiveError final : public InputError {
 public:
  LiveError(std::string code, const std::string& words, std::string field = "")
      : InputError(words), code_(std::move(code)), field_(std::move(field)) {}
  /// json, command, field, hello, version, token, full, rate, state or refused (docs/live-interface.md).
  [[nodiscard]] const std::string& code() const noexcept { return code_; }
  [[nodiscard]] const std::string& field() const noexcept { return field_; }

 private:
  std::string code_;
  std::string field_;
};

/// A tissue as an edit of another: what is not named stays.
struct TissueEdit {
  std::optional<std::string> preset;  // taken first
  std::optional<std::string> name;
  std::optional<model::LawKind> law;
  std::optional<model::RelaxationTerms> relaxation;  // all terms; SI
  std::vector<std::pair<const model::TissueField*, std::optional<double>>>
      numbers;  // SI; none: as if not given
};

/// Noise as an edit of another.
struct NoiseEdit {
  std::optional<bool> enabled;
  std::optional<double> gain;            // K [N m]
  std::optional<double> threshold;       // d0 [m]
  std::optional<double> user_threshold;  // N, with the share in place of a gain
  std::optional<double> share;
};

// The commands. Texts as they came; SI.
struct Hello {
  std::string token;
};
struct AskVersion {};
struct AskState {};
struct AskScene {};
struct AskSurface {
  bool at_rest = false;  // the whole organ at rest; else what has moved
};
struct Stream {
  double rate_Hz = 0.0;  // 0: no more
};
struct Load {
  std::optional<std::string> scene;  // a file below the server's folder; none: the built-in press or pull
  std::optional<std::string> task;
  std::optional<std::string> organ;
  std::optional<std::string> organ_unit;
  std::optional<std::string> tissue;
  std::optional<std::string> tool;
  std::optional<std::string> tool_unit;
  std::optional<std::string> device;  // a kind alone
  std::optional<double> rate_Hz;
  std::optional<std::uint64_t> seed;
  bool no_noise = false;
};
struct Start {};
struct Stop {};
struct SetTissue {
  TissueEdit edit;
};
struct SetNoise {
  NoiseEdit edit;
};
struct ResetFaults {};

using LiveCommand = std::variant<Hello, AskVersion, AskState, AskScene, AskSurface, Stream, Load, Start, Stop,
                                 SetTissue, SetNoise, ResetFaults>;

/// To which message an answer belongs.
struct LiveReference {
  std::string command;  // as "do" said it; empty: not known
  std::string id;       // as JSON; empty: none was given
};

struct LiveRequest {
  LiveReference reference;
  LiveCommand command;
};

/// [any] Not for the tick. Reads a message. @param reference what is known of it, also when it is refused
/// @throws LiveError: one line that names the field, its value and what would be right.
[[nodiscard]] LiveCommand read_live_message(std::string_view text, LiveReference& reference);

/// [setup] The tissue that an edit makes of another; not checked by model::validate(). @throws InputError for
/// a preset that is none.
[[nodiscard]] model::TissueParameters edited(model::TissueParameters tissue, const TissueEdit& edit);

/// [setup] The same of noise. @throws ParameterError for a threshold or share that are none.
[[nodiscard]] haptics::LiveNoise edited(haptics::LiveNoise noise, const NoiseEdit& edit);

}  // namespace palpate::net
