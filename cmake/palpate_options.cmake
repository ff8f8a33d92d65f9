# Compiler settings that every target shares.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")

# The same rows bit for bit at -O0 and -O2 on any x86-64: no contraction to fused multiply-add, one
# instruction set, no vectorised Eigen paths that would depend on it (docs/decisions/0001-determinism.md).
add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Werror -ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE EIGEN_MPL2_ONLY)
# Eigen's small functions are inlined everywhere, not where a compiler thinks it pays: a tick in contact takes 8 % less
# time by it (docs/decisions/0007), and with the address sanitizer tests that prepare organs half to two thirds less (0014).
add_compile_options("-DEIGEN_STRONG_INLINE=__attribute__((always_inline)) inline")

set(PALPATE_SANITIZE "" CACHE STRING "Sanitizers to build with, as for -fsanitize= (address,undefined or thread)")
if(PALPATE_SANITIZE)
  add_compile_options(-fsanitize=${PALPATE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PALPATE_SANITIZE})
endif()

option(PALPATE_FUZZ "Build the fuzz targets (fuzz/), and count edges in everything for them: clang++ only" OFF)
if(PALPATE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "PALPATE_FUZZ needs clang++ (cmake --preset asan), this is ${CMAKE_CXX_COMPILER}")
  endif()
  # Not libFuzzer's watch on every comparison (-fsanitize=fuzzer-no-link), which makes tests in the same build 2.3 times as
  # slow. tools/check_fuzz takes words from the seeds instead.
  add_compile_options(-fsanitize-coverage=inline-8bit-counters,pc-table)
endif()

option(PALPATE_CORE_ONLY "Build src/core alone: it needs Eigen and the standard library" OFF)
if(NOT PALPATE_CORE_ONLY)
  find_package(Threads REQUIRED)
endif()
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
  include(palpate_suites)
endif()

# The sources of a target are compiled joined, up to a dozen at a time, so that a header is read once for all of them
# (docs/decisions/0017-joined-sources.md). Names in unnamed namespaces are therefore unique within a target.
# -DCMAKE_UNITY_BUILD=OFF compiles each source alone: quicker when you change one source at a time.
set(CMAKE_UNITY_BUILD ON CACHE BOOL "Compile the sources of a target joined")
set(CMAKE_UNITY_BUILD_BATCH_SIZE 12 CACHE STRING "How many sources are joined at most")

# palpate_compile_quickly(TARGET): little optimised, as no hand, picture or fit waits for its code.
function(palpate_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()
