#pragma once
#include <cstdint>

#include "palpate/tool_path.h"

namespace palpate::devices {

inline constexpr double kRestAfterPath = 0.5;  // s, from a path's last row to the run's end

/// [any] round((end of the path + 0.5 s) x rate); 2^64-1 where no integer holds it.
[[nodiscard]] std::uint64_t last_tick_of(const scene::ToolPath& path, double rate_Hz) noexcept;

}  // namespace palpate::devices
