# palpate_module(NAME [HEADERS ...] [SUBFOLDERS ...] [DEPS ...] [PRIVATE_DEPS ...] [TEST_DEPS ...]): the library palpate_NAME
# (alias palpate::NAME) from the *.cc files of the current folder and its SUBFOLDERS, and a test program palpate_NAME_test from
# test/*_test.cc. HEADERS: its headers in include/palpate/ (tools/lint_modules). DEPS: module names or link targets. Targets that
# link a module see only the public headers in include/; sources of this repository that use src/ link palpate::private.
# TEST_PROPERTIES: CTest properties of each suite. The folders posix/ and windows/ implement the same functions for their system.
# NOT_PORTABLE: sources that the portable build leaves out (PALPATE_PORTABLE), there or in the system's folder. It takes those of
# the folder portable/ instead. NOT_WINDOWS: sources that palpate.exe leaves out. It takes those of the same name in portable/, and
# all in windows/.
add_library(palpate_private INTERFACE)
add_library(palpate::private ALIAS palpate_private)
target_include_directories(palpate_private INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR} ${PALPATE_SYSTEM_HEADERS})

function(palpate_module name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SUBFOLDERS;NOT_PORTABLE;NOT_WINDOWS;DEPS;PRIVATE_DEPS;TEST_DEPS;TEST_PROPERTIES" ${ARGN})
  list(TRANSFORM ARG_SUBFOLDERS APPEND "/*.cc")
  file(GLOB sources CONFIGURE_DEPENDS *.cc ${PALPATE_SYSTEM}/*.cc ${ARG_SUBFOLDERS})
  if(PALPATE_PORTABLE)
    foreach(name IN LISTS ARG_NOT_PORTABLE)
      list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cc ${CMAKE_CURRENT_SOURCE_DIR}/${PALPATE_SYSTEM}/${name}.cc)
    endforeach()
    file(GLOB instead CONFIGURE_DEPENDS portable/*.cc)
    list(APPEND sources ${instead})
  elseif(WIN32)
    foreach(name IN LISTS ARG_NOT_WINDOWS)
      list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cc)
      cmake_path(GET name FILENAME file)
      if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/portable/${file}.cc)
        list(APPEND sources ${CMAKE_CURRENT_SOURCE_DIR}/portable/${file}.cc)
      endif()
    endforeach()
  endif()
  set(components "")
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/components/")
    set(components ${PROJECT_SOURCE_DIR}/components)
  endif()
  add_library(palpate_${name} STATIC ${sources})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_include_directories(palpate_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PALPATE_SYSTEM_HEADERS}
    ${components} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
    $<INSTALL_INTERFACE:include>)
  target_link_libraries(palpate_${name} PUBLIC ${ARG_DEPS} PRIVATE ${ARG_PRIVATE_DEPS})

  file(GLOB tests CONFIGURE_DEPENDS test/*_test.cc)
  if(PALPATE_CORE_ONLY)  # without tests that need an organ or a file of other modules
    foreach(test IN LISTS tests)
      file(STRINGS ${test} others REGEX "^#include \"(palpate/(builtin|read_mesh)|io|run)/?")
      if(others)
        list(REMOVE_ITEM tests ${test})
      endif()
    endforeach()
  endif()
  if(BUILD_TESTING AND tests)
    add_executable(palpate_${name}_test ${tests})
    target_link_libraries(palpate_${name}_test PRIVATE palpate::${name} palpate::private ${ARG_TEST_DEPS} GTest::gmock
      GTest::gtest_main)
    target_include_directories(palpate_${name}_test PRIVATE ${components})
    palpate_compile_quickly(palpate_${name}_test)
    palpate_add_suites(palpate_${name}_test ${name} ${ARG_TEST_PROPERTIES})
  endif()
endfunction()
