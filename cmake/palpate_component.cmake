# palpate_component_program(NAME DEPS...): the program palpate-NAME from commands/*.cc of the current folder. It is built beside
# the program palpate, which executes it, and installed as the component NAME, a Debian package palpate-NAME.
function(palpate_component_program name)
  find_package(CLI11 REQUIRED)
  find_package(fmt REQUIRED)
  find_package(nlohmann_json REQUIRED)
  file(GLOB sources CONFIGURE_DEPENDS commands/*.cc)
  add_executable(palpate-${name} ${sources})
  # RPATH as in packaging/CMakeLists.txt.
  set_target_properties(palpate-${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/app BUILD_WITH_INSTALL_RPATH ON)
  target_link_libraries(palpate-${name} PRIVATE palpate::components ${ARGN} palpate_play CLI11::CLI11 nlohmann_json::nlohmann_json
    fmt::fmt)
  palpate_compile_quickly(palpate-${name})
endfunction()

# palpate_component_test(NAME PREFIX SOURCES... [MPI_SOURCES...] [DEPS...] [PROPERTIES...]): tests of the commands of component
# NAME, which run the program. Their suites are named PREFIX.SUITE. MPI_SOURCES are tests on several ranks: they need mpirun.
function(palpate_component_test name prefix)
  cmake_parse_arguments(ARG "" "" "SOURCES;MPI_SOURCES;DEPS;PROPERTIES" ${ARGN})
  add_executable(palpate_${name}_command_test ${ARG_SOURCES})
  find_program(PALPATE_MPIRUN mpirun)
  if(TARGET palpate_mpi AND PALPATE_MPIRUN)
    target_sources(palpate_${name}_command_test PRIVATE ${ARG_MPI_SOURCES})
    add_dependencies(palpate_${name}_command_test palpate_mpi)
  else()
    message(STATUS "No tests of palpate ${name} on several ranks: mpirun (openmpi-bin) or MPI (libopenmpi-dev) was not found")
  endif()
  target_compile_definitions(palpate_${name}_command_test PRIVATE PALPATE_PROGRAM="$<TARGET_FILE:palpate_app>"
    PALPATE_EXAMPLES="${PROJECT_SOURCE_DIR}/examples")
  target_link_libraries(palpate_${name}_command_test PRIVATE palpate::components ${ARG_DEPS} nlohmann_json::nlohmann_json
    GTest::gmock GTest::gtest_main)
  palpate_compile_quickly(palpate_${name}_command_test)
  add_dependencies(palpate_${name}_command_test palpate_app palpate-${name})
  palpate_add_suites(palpate_${name}_command_test ${prefix} ${ARG_PROPERTIES})
endfunction()

# What sources of components may include: those of the product, and those of their component as NAME/ROOM/FILE.h.
add_library(palpate_components INTERFACE)
add_library(palpate::components ALIAS palpate_components)
target_include_directories(palpate_components INTERFACE ${PROJECT_SOURCE_DIR}/components)
target_link_libraries(palpate_components INTERFACE palpate::private)
