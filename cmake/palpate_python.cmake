# Modules of the Python package palpate, in python/palpate of the build tree. Uses the system's Python, because another one on PATH
# may lack NumPy or have another extension interface.
set(Python_EXECUTABLE /usr/bin/python3)
find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module)
set(PYBIND11_FINDPYTHON ON)
find_package(pybind11 2.10 REQUIRED)

# palpate_python_docs(FOLDER HEADER...): generated/FOLDER/docs.h, docstrings from the comments of headers.
function(palpate_python_docs folder)
  set(docs ${PROJECT_BINARY_DIR}/generated/${folder}/docs.h)
  cmake_path(GET docs PARENT_PATH parent)
  set(make_docs ${PROJECT_SOURCE_DIR}/bindings/python/make_docs)
  add_custom_command(OUTPUT ${docs}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${parent}
    COMMAND ${Python_EXECUTABLE} ${make_docs} ${docs} ${ARGN}
    DEPENDS ${make_docs} ${ARGN} VERBATIM)
endfunction()

# palpate_python_module(TARGET NAME SOURCES... [DEPS...]): the extension NAME of the package.
function(palpate_python_module target name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  pybind11_add_module(${target} MODULE NO_EXTRAS ${ARG_SOURCES})
  # RPATH as in packaging/CMakeLists.txt.
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/palpate
    CXX_VISIBILITY_PRESET hidden BUILD_WITH_INSTALL_RPATH ON)
  target_link_libraries(${target} PRIVATE palpate_binding ${ARG_DEPS})
  palpate_compile_quickly(${target})
  set_property(GLOBAL APPEND PROPERTY PALPATE_PYTHON_PARTS ${target})
endfunction()

# palpate_python_files(FILE...): Python files of the package.
function(palpate_python_files)
  foreach(file IN LISTS ARGN)
    cmake_path(GET file FILENAME name)
    set(copy ${PROJECT_BINARY_DIR}/python/palpate/${name})
    add_custom_command(OUTPUT ${copy} COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_CURRENT_SOURCE_DIR}/${file} ${copy}
      DEPENDS ${file} VERBATIM)
    list(APPEND copies ${copy})
  endforeach()
  string(MAKE_C_IDENTIFIER palpate_python_${CMAKE_CURRENT_SOURCE_DIR} target)
  add_custom_target(${target} DEPENDS ${copies})
  set_property(GLOBAL APPEND PROPERTY PALPATE_PYTHON_PARTS ${target})
endfunction()

# palpate_python_package(): the target with all parts, and the type stubs for editors and mypy. make_stubs imports the package, so
# NumPy is needed.
function(palpate_python_package)
  get_property(parts GLOBAL PROPERTY PALPATE_PYTHON_PARTS)
  add_custom_target(palpate_python_package ALL DEPENDS ${parts})
  if(PALPATE_SANITIZE)  # an uninstrumented interpreter cannot load an instrumented module
    return()
  endif()
  set(stamp ${PROJECT_BINARY_DIR}/python/stubs.txt)
  set(make_stubs ${PROJECT_SOURCE_DIR}/bindings/python/make_stubs)
  add_custom_command(OUTPUT ${stamp}
    COMMAND ${Python_EXECUTABLE} -B ${make_stubs} ${PROJECT_BINARY_DIR}/python
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${make_stubs} ${parts} VERBATIM)
  add_custom_target(palpate_python_stubs DEPENDS ${stamp})
  add_dependencies(palpate_python_package palpate_python_stubs)
  if(BUILD_TESTING AND PALPATE_FIT AND PALPATE_STUDY AND PALPATE_LEARNING)  # docs/python.md describes them all
    palpate_python_test(Docs ${PROJECT_SOURCE_DIR}/bindings/python/test/test_docs.py)
  endif()
endfunction()

# palpate_python_test(NAME FILE...): the test python.NAME from files in test/.
function(palpate_python_test name)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/test/ REGEX "^[^/]")
  add_test(NAME python.${name}
    COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_BINARY_DIR}/python:${PROJECT_SOURCE_DIR}/bindings/python/test
      PALPATE_PROGRAM=$<TARGET_FILE:palpate_app> ${Python_EXECUTABLE} -B -m pytest -q -rs -p no:cacheprovider -p palpate_fixtures ${ARGN})
  set_tests_properties(python.${name} PROPERTIES TIMEOUT 600 COST 30 SKIP_RETURN_CODE 77 FIXTURES_REQUIRED cache
    ENVIRONMENT "PALPATE_CACHE=shared;XDG_CACHE_HOME=${PROJECT_BINARY_DIR}/test-cache")
endfunction()
