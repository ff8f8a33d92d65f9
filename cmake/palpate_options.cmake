# Compiler options of all targets.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")

# Rows are equal bit for bit at -O0 and -O2 on any x86-64: no contraction to fused multiply-add, one instruction set, no
# vectorised Eigen code that depends on it (docs/decisions/0001-determinism.md).
add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Werror -ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE EIGEN_MPL2_ONLY)
# Eigen's small functions are always inlined. This makes a tick in contact 8 % faster (docs/decisions/0007), and tests that
# prepare organs with the address sanitizer 50 to 67 % faster (0014).
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
  # Without libFuzzer's instrumentation of comparisons (-fsanitize=fuzzer-no-link), which makes tests in the same build 2.3 times
  # slower. tools/check_fuzz takes dictionaries from the seeds instead.
  add_compile_options(-fsanitize-coverage=inline-8bit-counters,pc-table)
endif()

option(PALPATE_CORE_ONLY "Build src/core alone: it needs Eigen and the standard library" OFF)
option(PALPATE_PORTABLE "Build the C interface for another system: presets linux, web, windows and aarch64" OFF)
# Sources of a folder of this name are for this system.
set(PALPATE_SYSTEM posix)
if(WIN32)
  set(PALPATE_SYSTEM windows)
  # No library of the compiler is needed beside a program.
  add_link_options(-static)
  add_compile_definitions(_WIN32_WINNT=0x0A00 _CRT_RAND_S NOMINMAX WIN32_LEAN_AND_MEAN)
endif()
set(PALPATE_SYSTEM_HEADERS ${PROJECT_SOURCE_DIR}/src/io/system/${PALPATE_SYSTEM})

if(PALPATE_PORTABLE)
  include(palpate_portable)
elseif(WIN32)
  include(palpate_windows)
else()
  if(NOT PALPATE_CORE_ONLY)
    find_package(Threads REQUIRED)
  endif()
  find_package(Eigen3 3.4 REQUIRED NO_MODULE)
endif()
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
  include(palpate_suites)
endif()

# Sources of a target are compiled together, so that each header is read once (docs/decisions/0017-joined-sources.md). Names in
# unnamed namespaces must therefore be unique within a target. -DCMAKE_UNITY_BUILD=OFF compiles each source separately, which is
# faster after a change of one source.
set(CMAKE_UNITY_BUILD ON CACHE BOOL "Compile the sources of a target joined")
set(CMAKE_UNITY_BUILD_BATCH_SIZE 0)

# palpate_compile_quickly(TARGET): low optimisation, for code whose speed does not matter to a run, picture or fit. At -Og g++ 12
# takes arguments of Eigen's inlined functions for uninitialized.
function(palpate_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>
    $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)
endfunction()
