# palpate_add_suites(TARGET PREFIX [PROPERTY VALUE...]): one CTest test per test suite of a GoogleTest program, named
# PREFIX.SUITE, in a separate process. Tests of a suite share slow preparations. The tests of SUITE include those of its
# instantiations (TEST_P, TYPED_TEST). A suite with a test that could not run (io/system/test/not_tested.h) is reported as skipped.
# All suites share one cache of prepared organs, which CTest empties before the first (tests/CMakeLists.txt): its key does not
# cover the code that prepares.
# This file runs itself as a script after the program is linked.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  # With a sanitizer these suites take minutes without covering more code: the finest built-in shapes, fits of many curves, many
  # simulated people, random paths and random pictures.
  set(PALPATE_LEFT_OUT "")
  if(PALPATE_SANITIZE)
    set(PALPATE_LEFT_OUT "*Fine*.*:*_300k:*ImageTrials.*:FitSpecimen.FindsRelaxation*:FitSpecimen.RelaxationTooFaint*:FitSpecimen.OrdersRelaxation*:"
      "FitSpecimen.IntervalsHold*:LumpsInATick.ClosedPaths*:Recovery.*:GroupStudy.*:Sweep.OfAllTogether*:Sweep.NoValueFitsClearly*:Minima.OfRandomSprings*:Rendered.*:RunSession.*:Power.*")
    list(JOIN PALPATE_LEFT_OUT "" PALPATE_LEFT_OUT)
  endif()
  set(PALPATE_SUITES_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

  function(palpate_add_suites target prefix)
    list(JOIN ARGN " " properties)
    set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
    add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${list} VERBATIM
      COMMAND ${CMAKE_COMMAND} "-Dprogram=$<TARGET_FILE:${target}>" "-Dprefix=${prefix}" "-Dlist=${list}"
        "-Dcache=${PROJECT_BINARY_DIR}/test-cache" "-Dleft_out=${PALPATE_LEFT_OUT}" "-Dproperties=TIMEOUT 600 SKIP_RETURN_CODE 77 ${properties}" -P ${PALPATE_SUITES_SCRIPT})
    set(include ${CMAKE_CURRENT_BINARY_DIR}/${target}_include.cmake)
    file(CONFIGURE OUTPUT ${include} @ONLY CONTENT "if(EXISTS \"@list@\")
  include(\"@list@\")
else()
  add_test(@prefix@.@target@_NOT_BUILT @target@_NOT_BUILT)
endif()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
  endfunction()
  return()
endif()

execute_process(COMMAND ${program} --gtest_list_tests "--gtest_filter=-${left_out}" OUTPUT_VARIABLE listed
  TIMEOUT 60 COMMAND_ERROR_IS_FATAL ANY)
# A suite's line is not indented and ends with a point: "Suite.", "Instance/Suite.", "Suite/0.  # TypeParam = int".
string(REGEX MATCHALL "(^|\n)[A-Za-z_][A-Za-z_0-9/]*\\.[^\n]*" lines "${listed}")
set(suites "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n?([^.]*)\\..*" "\\1" suite "${line}")
  string(REGEX REPLACE "/[0-9]+$" "" suite "${suite}")
  string(REGEX REPLACE "^.*/" "" suite "${suite}")
  list(APPEND suites ${suite})
endforeach()
list(REMOVE_DUPLICATES suites)
set(script "")
foreach(suite IN LISTS suites)
  set(filter "${suite}.*:*/${suite}.*:${suite}/*:*/${suite}/*-${left_out}")
  string(APPEND script "add_test([=[${prefix}.${suite}]=] [=[${program}]=] --gtest_brief=1 [=[--gtest_filter=${filter}]=])\n"
    "set_tests_properties([=[${prefix}.${suite}]=] PROPERTIES ${properties}\n"
    "  FIXTURES_REQUIRED cache ENVIRONMENT [=[PALPATE_CACHE=shared;XDG_CACHE_HOME=${cache}]=])\n")
endforeach()
file(WRITE ${list} "${script}")
