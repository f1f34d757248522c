set(FORCEBOUND_TEST_LABELS "" CACHE STRING
    "Regular expression: build and run only tests with such a label, a test without one having the label ''")

# forcebound_wants(LABEL RESULT): whether tests with this label, or none, are built and run.
function(forcebound_wants label result)
  set(wanted ON)
  if(FORCEBOUND_TEST_LABELS AND NOT "${label}" MATCHES "${FORCEBOUND_TEST_LABELS}")
    set(wanted OFF)
  endif()
  set(${result} ${wanted} PARENT_SCOPE)
endfunction()

# forcebound_tenths(LABEL RESULT): how much of a processor a test with this label gets, in tenths: ctest's PROCESSORS, of
# which deploy/test has ten for each processor. A test that starts programs mostly waits for them: it keeps a tenth or two
# of a processor busy, and under ThreadSanitizer up to half; the rest is left to the programs' threads of real time.
function(forcebound_tenths label result)
  set(tenths 10)
  if(label STREQUAL process AND NOT CMAKE_CXX_FLAGS MATCHES "fsanitize")
    set(tenths 5)
  endif()
  set(${result} ${tenths} PARENT_SCOPE)
endfunction()

# forcebound_leave_out(NAME REASON [LABEL]): in place of a test that cannot be built or run here, one that says so and
# counts as skipped.
function(forcebound_leave_out name reason)
  forcebound_wants("${ARGN}" wanted)
  if(NOT wanted)
    return()
  endif()
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: ${reason}")
  set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED:" LABELS "${ARGN}")
endfunction()

# forcebound_find_for_tests(PACKAGE [VERSION least BELOW version] DEBIAN package [HEADER regular expression]): a library
# that some tests use, linked by the package's name. Where it is missing, or of another version, the sources that include
# its header, themselves or by one of tests/support, are left out of their tests, and said to be.
function(forcebound_find_for_tests package)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "VERSION;BELOW;DEBIAN;HEADER" "")
  find_package(${package} QUIET)
  set(reason)
  if(NOT ${package}_FOUND)
    set(reason "${package} is not installed")
  elseif(arg_VERSION AND
         (${package}_VERSION VERSION_LESS arg_VERSION OR ${package}_VERSION VERSION_GREATER_EQUAL arg_BELOW))
    set(reason "${package} is ${${package}_VERSION}, wanted is ${arg_VERSION} or newer, before ${arg_BELOW}")
  endif()
  if(reason)
    message(STATUS "Without some tests: ${reason} (Debian: ${arg_DEBIAN})")
    set(reason "${reason} (Debian: ${arg_DEBIAN})")
    file(GLOB support CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/support/*.hpp)
    forcebound_includers("${arg_HEADER}" "${support}" headers)
    list(TRANSFORM headers REPLACE "^${PROJECT_SOURCE_DIR}/" "")
    list(APPEND headers ${arg_HEADER})
    list(JOIN headers "|" headers)
    set_property(GLOBAL PROPERTY FORCEBOUND_HEADERS_OF_${package} "${headers}")
  endif()
  set_property(GLOBAL PROPERTY FORCEBOUND_WITHOUT_${package} "${reason}")
endfunction()

# forcebound_includers(HEADERS FILES RESULT): those of the files that include a header whose name matches.
function(forcebound_includers headers files result)
  set(found)
  foreach(file IN LISTS files)
    file(STRINGS ${file} lines REGEX "^#include [<\"](${headers})[>\"]" LIMIT_COUNT 1)
    if(lines)
      list(APPEND found ${file})
    endif()
  endforeach()
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# forcebound_without(TARGET LINK RESULT [LABEL]): leaves out the sources of a test that need what of LINK is not here;
# RESULT is the rest of LINK.
function(forcebound_without target link result)
  get_target_property(sources ${target} SOURCES)
  list(TRANSFORM sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" REGEX "^[^/]")
  set(here)
  foreach(library IN LISTS link)
    get_property(reason GLOBAL PROPERTY FORCEBOUND_WITHOUT_${library})
    if(NOT reason)
      list(APPEND here ${library})
      continue()
    endif()
    get_property(headers GLOBAL PROPERTY FORCEBOUND_HEADERS_OF_${library})
    forcebound_includers("${headers}" "${sources}" unused)
    set_source_files_properties(${unused} PROPERTIES HEADER_FILE_ONLY ON)
    list(TRANSFORM unused REPLACE "^.*/" "" OUTPUT_VARIABLE names)
    list(JOIN names " " names)
    forcebound_leave_out(${target}.without_${library} "${reason}: without ${names}" ${ARGN})
  endforeach()
  set(${result} "${here}" PARENT_SCOPE)
endfunction()

set(FORCEBOUND_TEST_OPTIONS "" CACHE STRING
    "Options for compiling the tests' own sources, after all others: they may be optimised less than what they test")

option(FORCEBOUND_SLOW_CASES "Run also the cases that tests declare as slow under sanitizers" ON)

# Precompiled headers that nearly every test uses. No headers of ours: a change of one would compile everything again.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/test_headers.cpp CONTENT "// A target needs a source.\n")
add_library(forcebound_test_headers OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/test_headers.cpp)
target_link_libraries(forcebound_test_headers PRIVATE forcebound_options Eigen3::Eigen GTest::gmock)
target_compile_options(forcebound_test_headers PRIVATE ${FORCEBOUND_TEST_OPTIONS})
target_precompile_headers(forcebound_test_headers PRIVATE
  <algorithm> <array> <chrono> <cmath> <functional> <memory> <random> <string> <vector> <Eigen/Dense> <gmock/gmock.h>
  <gtest/gtest.h>)

# forcebound_test(NAME [FOLDER folder | SOURCES ...] LINK ... [LABELS label] [TIMEOUT S] [SHARDS N] [SERIAL]
#                 [SLOW_CASES ...] [PROPERTIES ...]): the GoogleTest executable NAME, of the named sources or every
# source of a folder. It is one CTest, or N that share its tests. Tests see the source root, for "tests/support/...".
# With FORCEBOUND_UNITY its sources are compiled together, so none of them may use another's name for something else.
# SERIAL: nothing else runs beside it, for tests in real time. The label `long` keeps a test out of deploy/test unless
# --long is given. The gate (.ci/run) runs a test without a label under AddressSanitizer, `threads` under
# ThreadSanitizer too, `numbers`, whose results an optimiser could change, in its optimised build too, `process` there
# and under ThreadSanitizer, `studies` there alone. SLOW_CASES are patterns of GoogleTest's names: without
# FORCEBOUND_SLOW_CASES these are left out. They take minutes under sanitizers, and repeat for many ticks what other cases
# run there too.
function(forcebound_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SERIAL" "FOLDER;TIMEOUT;SHARDS" "SOURCES;LINK;LABELS;PROPERTIES;SLOW_CASES")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 900)
  endif()
  if(NOT arg_SHARDS)
    set(arg_SHARDS 1)
  endif()
  if(arg_FOLDER)
    file(GLOB_RECURSE arg_SOURCES CONFIGURE_DEPENDS ${arg_FOLDER}/*.cpp)
  endif()
  add_executable(${name} ${arg_SOURCES})
  forcebound_compile_together(${name})
  target_compile_options(${name} PRIVATE ${FORCEBOUND_TEST_OPTIONS})
  target_precompile_headers(${name} REUSE_FROM forcebound_test_headers)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  forcebound_leave_out_libraries(arg_LINK)
  forcebound_without(${name} "${arg_LINK}" arg_LINK ${arg_LABELS})
  target_link_libraries(${name} PRIVATE ${arg_LINK} forcebound_test_support GTest::gmock_main forcebound_options)
  forcebound_wants("${arg_LABELS}" wanted)
  if(NOT wanted)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  list(JOIN arg_SLOW_CASES ":" slow_cases)
  math(EXPR last "${arg_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(test ${name})
    if(arg_SHARDS GREATER 1)
      math(EXPR number "${shard} + 1")
      set(test ${name}.${number})
    endif()
    add_test(NAME ${test} COMMAND ${name})
    forcebound_tenths("${arg_LABELS}" tenths)
    set_tests_properties(${test} PROPERTIES TIMEOUT ${arg_TIMEOUT} RUN_SERIAL ${arg_SERIAL} LABELS "${arg_LABELS}"
                         PROCESSORS ${tenths} ${arg_PROPERTIES})
    set_property(TEST ${test} PROPERTY ENVIRONMENT GTEST_TOTAL_SHARDS=${arg_SHARDS} GTEST_SHARD_INDEX=${shard})
    if(slow_cases AND NOT FORCEBOUND_SLOW_CASES)
      # Appended: deploy/test --only sets the variable too.
      set_property(TEST ${test} PROPERTY ENVIRONMENT_MODIFICATION "GTEST_FILTER=string_append:-${slow_cases}")
    endif()
  endforeach()
endfunction()
