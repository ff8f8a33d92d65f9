# The portable build (presets linux, web, windows, aarch64): the simulation behind the C interface, without threads, HDF5, assimp,
# zlib, TBB and devices other than scripted ones. It links no library of this machine. Of its libraries it takes the headers.
include(palpate_headers)
# The modules' find_package() find the targets of palpate_headers, or nothing that the portable build links.
palpate_headers_of(eigen3/Eigen fmt toml++ stb FOUND Eigen3 fmt tomlplusplus TBB nlohmann_json assimp ZLIB)

if(EMSCRIPTEN)
  # The library throws. WebAssembly's own exceptions cost nothing where none is thrown.
  # Without -msimd128, which clang 14 compiles wrongly (docs/decisions/0026-one-order-everywhere.md).
  add_compile_options(-fwasm-exceptions)
  # Sizes have 32 bits, so that indices of other types warn. The other builds check conversions.
  add_compile_options(-Wno-sign-conversion -Wno-shorten-64-to-32)
  add_link_options(-fwasm-exceptions -sALLOW_MEMORY_GROWTH)
  set(CMAKE_EXECUTABLE_SUFFIX .js)
endif()
