# The portable build (presets linux, web, windows, aarch64): the simulation behind the C interface, without threads, HDF5, assimp,
# zlib, TBB and devices other than scripted ones. It links no library of this machine. Of its libraries it takes the headers,
# in a folder of their own so that the compiler sees no other header of /usr/include.
set(PALPATE_HEADERS /usr/include CACHE PATH "Folder of eigen3/, fmt/, toml++/ and stb/")
set(headers ${PROJECT_BINARY_DIR}/headers)
set(find_modules ${PROJECT_BINARY_DIR}/find)
file(MAKE_DIRECTORY ${headers} ${find_modules})
foreach(folder IN ITEMS eigen3/Eigen fmt toml++ stb)
  if(NOT EXISTS ${PALPATE_HEADERS}/${folder})
    message(FATAL_ERROR "${PALPATE_HEADERS}/${folder}: missing; tools/setup.sh installs it, or set PALPATE_HEADERS")
  endif()
  cmake_path(GET folder FILENAME name)
  file(CREATE_LINK ${PALPATE_HEADERS}/${folder} ${headers}/${name} SYMBOLIC)
endforeach()
add_library(palpate_headers INTERFACE)
target_include_directories(palpate_headers SYSTEM INTERFACE ${headers})
target_compile_definitions(palpate_headers INTERFACE FMT_HEADER_ONLY TOML_HEADER_ONLY=1)
add_library(Eigen3::Eigen ALIAS palpate_headers)
add_library(fmt::fmt ALIAS palpate_headers)
add_library(tomlplusplus::tomlplusplus ALIAS palpate_headers)

# The modules' find_package() find the targets above, or nothing that the portable build links.
foreach(package IN ITEMS Eigen3 fmt tomlplusplus TBB nlohmann_json assimp ZLIB)
  file(WRITE ${find_modules}/Find${package}.cmake "set(${package}_FOUND TRUE)\n")
endforeach()
list(PREPEND CMAKE_MODULE_PATH ${find_modules})

if(EMSCRIPTEN)
  # The library throws. WebAssembly's own exceptions cost nothing where none is thrown.
  # Without -msimd128, which clang 14 compiles wrongly (docs/decisions/0026-one-order-everywhere.md).
  add_compile_options(-fwasm-exceptions)
  # Sizes have 32 bits, so that indices of other types warn. The other builds check conversions.
  add_compile_options(-Wno-sign-conversion -Wno-shorten-64-to-32)
  add_link_options(-fwasm-exceptions -sALLOW_MEMORY_GROWTH)
  set(CMAKE_EXECUTABLE_SUFFIX .js)
elseif(WIN32)
  # No library of the compiler is needed beside a program.
  add_link_options(-static)
  add_compile_definitions(_WIN32_WINNT=0x0A00 _CRT_RAND_S)
endif()
