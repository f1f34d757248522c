include(GNUInstallDirs)
include(ForceboundInstall)

# Headers are included as <forcebound/control/law.hpp>, installed or not. In the build tree these links make it so.
set(FORCEBOUND_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${FORCEBOUND_INCLUDE_DIR}/forcebound)
foreach(concept control text time wire net record)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/common/${concept} ${FORCEBOUND_INCLUDE_DIR}/forcebound/${concept} SYMBOLIC)
endforeach()
foreach(side client server)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${side} ${FORCEBOUND_INCLUDE_DIR}/forcebound/${side} SYMBOLIC)
endforeach()

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(FORCEBOUND_CCACHE ccache)
  if(FORCEBOUND_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${FORCEBOUND_CCACHE})
  endif()
endif()

# How we build ourselves; never reaches a consumer.
add_library(forcebound_options INTERFACE)
target_compile_options(forcebound_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -ffp-contract=off)
target_compile_definitions(forcebound_options INTERFACE FORCEBOUND_VERSION="${PROJECT_VERSION}")
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(forcebound_options INTERFACE -Werror)
endif()

# forcebound_library(NAME [SOURCES ...] [LINK ...] [LINK_PRIVATE ...]): the library of one concept, as forcebound::NAME,
# installed as find_package component NAME. Without sources it is headers only.
function(forcebound_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK;LINK_PRIVATE")
  set(target forcebound_${name})
  set(headers_from $<BUILD_INTERFACE:${FORCEBOUND_INCLUDE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    set(reach PUBLIC)
    # A stranger may put us into a plugin.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(${target} PRIVATE ${arg_LINK_PRIVATE} $<BUILD_INTERFACE:forcebound_options>)
  else()
    add_library(${target} INTERFACE)
    set(reach INTERFACE)
  endif()
  add_library(forcebound::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} ${reach} cxx_std_20)
  target_include_directories(${target} ${reach} ${headers_from})
  target_link_libraries(${target} ${reach} ${arg_LINK})

  forcebound_is_for_others(installed)
  if(installed)
    forcebound_install_headers(${name})
    forcebound_component(${name} LINKED ${arg_LINK} ${arg_LINK_PRIVATE})
  endif()
endfunction()

# forcebound_program(NAME SOURCES ... LINK ...): the executable NAME, in bin/ of the build tree; installed if it is called
# forcebound-something.
function(forcebound_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_executable(${name} ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  target_link_libraries(${name} PRIVATE ${arg_LINK} forcebound_options)
  if(FORCEBOUND_INSTALL AND name MATCHES "^forcebound-")
    install(TARGETS ${name} RUNTIME COMPONENT programs)
  endif()
endfunction()

set(FORCEBOUND_TEST_LABELS "" CACHE STRING "Regular expression: build and run only GoogleTests with such a label")

# forcebound_test(NAME SOURCES ... LINK ... [LABELS ...] [TIMEOUT S] [SERIAL] [PROPERTIES ...]): GoogleTest executable
# NAME; every TEST is a CTest of its own, with these properties. Tests see the source root, for "tests/support/...".
# SERIAL: nothing else runs beside it, for tests
# that measure time. The label `long` keeps a test out of deploy/test unless --long is given; `threads` runs it under
# ThreadSanitizer as well.
function(forcebound_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SERIAL" "TIMEOUT" "SOURCES;LINK;LABELS;PROPERTIES")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${arg_LINK} GTest::gmock_main forcebound_options)
  if(FORCEBOUND_TEST_LABELS AND NOT "${arg_LABELS}" MATCHES "${FORCEBOUND_TEST_LABELS}")
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  set(properties TIMEOUT ${arg_TIMEOUT} RUN_SERIAL ${arg_SERIAL} ${arg_PROPERTIES})
  if(arg_LABELS)
    # A list falls apart on its way through the discovery, and its second label would quietly be none.
    list(LENGTH arg_LABELS labels)
    if(labels GREATER 1)
      message(FATAL_ERROR "${name}: one label is possible, got '${arg_LABELS}'")
    endif()
    list(APPEND properties LABELS ${arg_LABELS})
  endif()
  # A busy machine may need more than the usual five seconds to list the tests of a program with sanitizers.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
endfunction()
