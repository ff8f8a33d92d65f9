#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "net/live_observer.h"
#include "net/live_protocol.h"
#include "palpate/parameter_updates.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/tissue.h"

// Messages that the live interface sends (docs/live-interface.md). All [any], not for the tick.
namespace palpate::net {

/// One tick of a run, as sent to clients.
struct LiveState {
  std::uint64_t run = 0;  // number of the run, from 1 on
  Pose organ_W;           // at that tick
  const LiveTick* tick = nullptr;
  std::optional<double> rate_Hz{};  // of the ticks, over the last second; none at first
};

/// Tissue and noise with the names and units of tissue and scene files.
[[nodiscard]] nlohmann::ordered_json tissue_json(const model::TissueParameters& tissue);
[[nodiscard]] nlohmann::ordered_json noise_json(const haptics::LiveNoise& noise);

/// A scene without its meshes.
[[nodiscard]] nlohmann::ordered_json scene_json(const scene::Scene& scene);

/// One tick: SI, world frame.
[[nodiscard]] nlohmann::ordered_json state_json(const LiveState& state);

/// {"answer": COMMAND, "id": ..., members}.
[[nodiscard]] std::string answer_text(const LiveReference& reference, const nlohmann::ordered_json& members);

/// {"error": {"code": ..., "field": ..., "words": ...}, "answer": ..., "id": ...}.
[[nodiscard]] std::string error_text(const LiveReference& reference, const InputError& error);

/// {"event": NAME, members}.
[[nodiscard]] std::string event_text(const std::string& name, const nlohmann::ordered_json& members);

/// {"left_out": ..., "state": ...}. @param state as text @param left_out dropped frames of the client
[[nodiscard]] std::string frame_text(const std::string& state, std::uint64_t left_out);

/// The text of a JSON document on one line; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string text_of(const nlohmann::ordered_json& json);

}  // namespace palpate::net
