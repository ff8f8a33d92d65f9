#pragma once
#include <cstddef>
#include <cstdint>

#include "core/deform/block_inverse.h"

namespace palpate::deform {

/// Where the panels of an inverse go (BlockInverse), and how work is shared among processors.
struct Panels {
  using Body = void (*)(const void* of, std::size_t begin, std::size_t end);
  using InRanges = void (*)(std::size_t count, Body body, const void* of);

  std::int16_t* end;   // of the entries, which are written from the last panel to the first
  float* scale;        // per column
  InRanges in_ranges;  // for_ranges() by plain functions
};

/// [setup] Computes all panels; overwrites the matrix. @return false when it is not positive
[[nodiscard]] bool inverse_panels(BlockMatrix& matrix, const Panels& to);
/// The same for processors with AVX2 and fused multiply-add, in about a third of the time. Single precision
/// is rounded elsewhere. Only where PALPATE_WITH_AVX2 is defined.
[[nodiscard]] bool inverse_panels_avx2(BlockMatrix& matrix, const Panels& to);

}  // namespace palpate::deform
