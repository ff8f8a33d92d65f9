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

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
  include(palpate_suites)
endif()

option(PALPATE_PRECOMPILE "Read the headers of others once a target, not once a source" ON)
set(PALPATE_PRECOMPILED <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory>
  <optional> <random> <span> <sstream> <string> <thread> <utility> <vector> <Eigen/Core> <Eigen/Geometry>)
if(PALPATE_PRECOMPILE)
  # A precompiled header is for sources with the same definitions, and SDL's users have this one.
  add_compile_definitions(_REENTRANT)
  # g++ 12 forgets in a precompiled header that std::string is the system's, and then warns of what it inlines of it.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict)
  endif()
  # What libraries share, and what test programs share: they differ in -fPIC and -fPIE.
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/precompiled.cc CONTENT "int main() { return 0; }\n")
  add_library(palpate_precompiled STATIC EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/generated/precompiled.cc)
  target_link_libraries(palpate_precompiled PRIVATE Eigen3::Eigen Threads::Threads)
  target_precompile_headers(palpate_precompiled PRIVATE ${PALPATE_PRECOMPILED})
  if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
    add_executable(palpate_precompiled_test EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/generated/precompiled.cc)
    target_link_libraries(palpate_precompiled_test PRIVATE Eigen3::Eigen Threads::Threads GTest::gmock)
    target_compile_options(palpate_precompiled_test PRIVATE $<$<CONFIG:Release>:-O1>)
    target_precompile_headers(palpate_precompiled_test PRIVATE ${PALPATE_PRECOMPILED} <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()

# palpate_compile_quickly(TARGET): little optimised, as no hand, picture or fit waits for its code.
function(palpate_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# palpate_precompile(TARGET REUSE_FROM OTHER | TARGET HEADER...): with headers beside the usual ones, its own.
function(palpate_precompile target)
  if(PALPATE_PRECOMPILE AND ARGV1 STREQUAL "REUSE_FROM")
    target_precompile_headers(${target} REUSE_FROM ${ARGV2})
  elseif(PALPATE_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${PALPATE_PRECOMPILED} ${ARGN})
  endif()
endfunction()
