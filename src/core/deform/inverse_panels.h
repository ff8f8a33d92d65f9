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

/// What takes the time of an inverse, for one kind of processor.
struct PanelKernel {
  /// [any] Replaces a matrix by Cholesky's factor. @return false when it is not positive
  bool (*factorize)(BlockMatrix& matrix);
  /// [any] Replaces columns by those of the inverse times them. @param factor of factorize()
  void (*solve)(BlockMatrix& factor, double* columns, std::size_t count);
  /// [setup] Computes all panels of the inverse plus A A'. @param factor of factorize()
  /// @param added the `count` columns of A @return false when a number is not finite
  bool (*compute)(BlockMatrix& factor, const float* added, std::size_t count, const Panels& to);
};

/// [any] For all processors.
[[nodiscard]] const PanelKernel& panel_kernel() noexcept;
/// [any] For processors with AVX2 and fused multiply-add, in about a third of the time. Single precision is
/// rounded elsewhere. Only where PALPATE_WITH_AVX2 is defined.
[[nodiscard]] const PanelKernel& panel_kernel_avx2() noexcept;

}  // namespace palpate::deform
