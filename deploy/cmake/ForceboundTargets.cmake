include(GNUInstallDirs)
include(ForceboundInstall)

# A header is included by its path below common/, client/ or server/, installed or not:
# common/forcebound/control/law.hpp is <forcebound/control/law.hpp>. What is not installed, below tests/, is included by
# its path from the repository's root.

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(FORCEBOUND_CCACHE ccache)
  if(FORCEBOUND_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${FORCEBOUND_CCACHE})
  endif()
endif()

# Two thirds of compiling a source is reading the headers of Eigen and the standard library; several sources compiled as one
# read them once. OFF finds missing includes that another source of the same unit provided; in tests, only together with
# CMAKE_DISABLE_PRECOMPILE_HEADERS.
option(FORCEBOUND_UNITY "Compile several sources of a library or test together" ${PROJECT_IS_TOP_LEVEL})

# forcebound_compile_together(TARGET): if FORCEBOUND_UNITY is set.
function(forcebound_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${FORCEBOUND_UNITY} UNITY_BUILD_BATCH_SIZE 20)
endfunction()

# forcebound_compile_quickly(TARGET...): -O1 in optimised builds too, a fifth less to compile: for what reads files and
# command lines, serves pages and writes reports, never for what runs in a tick or answers a motion.
function(forcebound_compile_quickly)
  foreach(target IN LISTS ARGN)
    if(FORCEBOUND_ONLY AND NOT TARGET ${target})
      continue()
    endif()
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-O1>)
  endforeach()
endfunction()

option(FORCEBOUND_WARNINGS_ARE_ERRORS "Stop at a warning in Forcebound's own code, with the compiler it is developed with"
       OFF)
# Another one, or another version, warns of other things: these are shown, and stop nobody's build.
set(developed_with GNU-12)
string(REGEX MATCH "^[0-9]+" major "${CMAKE_CXX_COMPILER_VERSION}")

# Settings of our own build; never passed on to a consumer.
add_library(forcebound_options INTERFACE)
target_compile_features(forcebound_options INTERFACE cxx_std_20)
# Eigen counts in signed numbers and the standard library in unsigned ones. g++ does not warn; clang-tidy would.
target_compile_options(forcebound_options INTERFACE
                       -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion -Wshadow -ffp-contract=off)
# An assertion names its source from the repository's root, wherever that is: what one clone has compiled, ccache finds for
# another, and no program has the path of the machine that built it.
target_compile_options(forcebound_options INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}/=)
target_compile_definitions(forcebound_options INTERFACE FORCEBOUND_VERSION="${PROJECT_VERSION}")
# What sanitizers replace, such as malloc, is left to them; g++ says by itself which there are.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=[a-z,-]*address")
  target_compile_definitions(forcebound_options INTERFACE __SANITIZE_ADDRESS__)
endif()
if(FORCEBOUND_WARNINGS_ARE_ERRORS AND "${CMAKE_CXX_COMPILER_ID}-${major}" STREQUAL developed_with)
  target_compile_options(forcebound_options INTERFACE -Werror)
endif()

option(FORCEBOUND_WITH_MUJOCO "Rigid bodies in scenes, if MuJoCo is found" ON)

# forcebound_find_mujoco(): sets FORCEBOUND_MUJOCO to whether rigid bodies are built. Without them a scene with a
# [[body]] is refused with the reason.
macro(forcebound_find_mujoco)
  set(FORCEBOUND_MUJOCO OFF)
  if(FORCEBOUND_WITH_MUJOCO)
    find_package(mujoco QUIET)
    find_package(tinyxml2 QUIET)
    if(mujoco_FOUND AND tinyxml2_FOUND)
      set(FORCEBOUND_MUJOCO ON)
    endif()
  endif()
  if(NOT FORCEBOUND_MUJOCO)
    set(FORCEBOUND_WITHOUT_MUJOCO "MuJoCo is not installed (Debian: libmujoco-dev libqhull-dev libtinyxml2-dev)")
    message(STATUS "Without rigid bodies in scenes, robots and their tests: ${FORCEBOUND_WITHOUT_MUJOCO}")
  endif()
endmacro()

# forcebound_find_dds(): sets FORCEBOUND_ROS2 to whether forcebound-ros2 is built, where it is wanted.
macro(forcebound_find_dds)
  if(FORCEBOUND_ROS2)
    find_package(CycloneDDS 0.10 QUIET)
    find_program(FORCEBOUND_IDLC idlc)
    mark_as_advanced(FORCEBOUND_IDLC)
    if(NOT CycloneDDS_FOUND OR NOT FORCEBOUND_IDLC)
      set(FORCEBOUND_ROS2 OFF)
      message(STATUS "Without forcebound-ros2: Cyclone DDS is not installed (Debian: cyclonedds-dev cyclonedds-tools)")
    endif()
  endif()
endmacro()

# forcebound_by(OPTION WITH source... WITHOUT source...): which sources of the current folder are for builds with the option
# alone, and which replace them without.
function(forcebound_by option)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "WITH;WITHOUT")
  set(unused ${arg_WITH})
  if(${option})
    set(unused ${arg_WITHOUT})
  endif()
  list(TRANSFORM unused PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set_source_files_properties(${unused} PROPERTIES HEADER_FILE_ONLY ON)
endfunction()

# forcebound_for_system(LIST): of a list of sources, those of the system that is built for. What is in a folder `windows`
# is for Windows alone, and takes the place there of the source of the same name beside that folder.
function(forcebound_for_system list)
  set(others ${${list}})
  list(FILTER others INCLUDE REGEX "/windows/[^/]+$")
  if(WIN32)
    list(TRANSFORM others REPLACE "/windows/([^/]+)$" "/\\1")
  endif()
  list(REMOVE_ITEM ${list} "" ${others})
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# forcebound_may_include(FOLDER WHAT...): the headers that files below FOLDER may include, beside their own: those of
# libraries or programs, or those below folders. Folders are as includes name them. A library or program may include what
# it links; this adds to that, and gives a folder within it a rule of its own. tests/architecture checks all files.
function(forcebound_may_include folder)
  set_property(GLOBAL APPEND PROPERTY FORCEBOUND_FOLDERS ${folder})
  set_property(GLOBAL APPEND PROPERTY FORCEBOUND_INCLUDES_OF_${folder} ${ARGN})
endfunction()

# forcebound_write_include_rule(FILE): a line "FOLDER: FOLDER..." for each folder of which is said what it may include.
function(forcebound_write_include_rule file)
  get_property(folders GLOBAL PROPERTY FORCEBOUND_FOLDERS)
  list(REMOVE_DUPLICATES folders)
  set(rule)
  foreach(folder IN LISTS folders)
    get_property(names GLOBAL PROPERTY FORCEBOUND_INCLUDES_OF_${folder})
    set(known)
    foreach(name IN LISTS names)
      if(name MATCHES "^(forcebound|tests)(/|$)")
        list(APPEND known ${name})
      elseif(name MATCHES "^forcebound(::|_)(.+)$")
        get_property(of_library GLOBAL PROPERTY FORCEBOUND_FOLDER_OF_forcebound_${CMAKE_MATCH_2})
        if(NOT of_library AND NOT TARGET ${name})
          message(FATAL_ERROR "${folder} may include ${name}: there is no such library")
        endif()
        list(APPEND known ${of_library})
      endif()
    endforeach()
    list(REMOVE_DUPLICATES known)
    list(SORT known)
    list(JOIN known " " known)
    string(APPEND rule "${folder}: ${known}\n")
  endforeach()
  file(CONFIGURE OUTPUT ${file} CONTENT "${rule}")
endfunction()

# forcebound_library(NAME [NEEDS option] [FOLDER folder] [LINK ...] [LINK_PRIVATE ...]): every source of one folder as the
# static library forcebound::NAME, which others find as package component NAME. The folder is forcebound/NAME below the
# current one; of client_session and server_session it is forcebound/client/session and forcebound/server/session. FOLDER
# names it below forcebound/client or forcebound/server where the library's name does not, and from the current folder
# below tests/. WITH_MUJOCO is linked, as LINK_PRIVATE is, where rigid bodies are built. A library that NEEDS an option is
# built where that is on; elsewhere, what is declared after it and links it does without.
function(forcebound_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "NOT_INSTALLED" "FOLDER;NEEDS" "LINK;LINK_PRIVATE;WITH_MUJOCO")
  forcebound_folder(${name} "${arg_FOLDER}" root folder)
  set(target forcebound_${name})
  set_property(GLOBAL PROPERTY FORCEBOUND_FOLDER_OF_${target} ${folder})
  forcebound_may_include(${folder} ${arg_LINK} ${arg_LINK_PRIVATE} ${arg_WITH_MUJOCO})
  if(FORCEBOUND_MUJOCO)
    list(APPEND arg_LINK_PRIVATE ${arg_WITH_MUJOCO})
  endif()
  if((arg_NEEDS AND NOT ${arg_NEEDS}) OR (FORCEBOUND_ONLY AND NOT name IN_LIST FORCEBOUND_ONLY))
    set_property(GLOBAL APPEND PROPERTY FORCEBOUND_LEFT_OUT forcebound::${name})
    return()
  endif()
  forcebound_leave_out_libraries(arg_LINK arg_LINK_PRIVATE)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${root}/${folder}/*.cpp)
  forcebound_for_system(sources)
  add_library(${target} STATIC ${sources})
  add_library(forcebound::${name} ALIAS ${target})
  forcebound_compile_together(${target})
  # A consumer may link us into a plug-in.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${arg_LINK} PRIVATE ${arg_LINK_PRIVATE} $<BUILD_INTERFACE:forcebound_options>)

  if(FORCEBOUND_INSTALL AND NOT arg_NOT_INSTALLED AND NOT folder MATCHES "^tests/")
    install(DIRECTORY ${root}/${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT ${name}
            FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" PATTERN "internal" EXCLUDE)
    forcebound_component(${name} LINKED ${arg_LINK} ${arg_LINK_PRIVATE})
  endif()
endfunction()

# forcebound_program(NAME FOLDER folder [WITHOUT ...] [LINK ...]): the executable NAME of FOLDER's main.cpp, in bin/ of the
# build tree, installed. The folder's other sources are the library NAME_app, for tests without a process; those of the
# folders below it that WITHOUT names are libraries of their own.
function(forcebound_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FOLDER" "WITHOUT;LINK")
  forcebound_folder(${name} "${arg_FOLDER}" root folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${root}/${folder}/*.cpp)
  list(REMOVE_ITEM sources ${root}/${folder}/main.cpp)
  foreach(other IN LISTS arg_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "^${root}/${folder}/${other}/")
  endforeach()
  string(REPLACE "-" "_" app ${name}_app)
  set_property(GLOBAL PROPERTY FORCEBOUND_FOLDER_OF_${app} ${folder})
  forcebound_may_include(${folder} ${arg_LINK})
  forcebound_leave_out_libraries(arg_LINK)
  add_library(${app} STATIC ${sources})
  forcebound_compile_together(${app})
  target_include_directories(${app} PUBLIC ${root})
  target_link_libraries(${app} PUBLIC ${arg_LINK} PRIVATE forcebound_options)
  add_executable(${name} ${root}/${folder}/main.cpp)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  target_link_libraries(${name} PRIVATE ${app} forcebound_options)
  if(FORCEBOUND_INSTALL)
    install(TARGETS ${name} RUNTIME COMPONENT programs)
  endif()
endfunction()

# forcebound_leave_out_libraries(LIST...): takes from each list the libraries that are not built.
function(forcebound_leave_out_libraries)
  get_property(left_out GLOBAL PROPERTY FORCEBOUND_LEFT_OUT)
  foreach(list IN LISTS ARGN)
    list(REMOVE_ITEM ${list} ${left_out})
    set(${list} ${${list}} PARENT_SCOPE)
  endforeach()
endfunction()

# Where a library or program lies: FOLDER below ROOT, ROOT being what its headers are included from.
function(forcebound_folder name below root folder)
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME side)
  if(NOT CMAKE_CURRENT_SOURCE_DIR STREQUAL ${PROJECT_SOURCE_DIR}/${side})
    file(RELATIVE_PATH here ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    set(${root} ${PROJECT_SOURCE_DIR} PARENT_SCOPE)
    set(${folder} ${here}/${below} PARENT_SCOPE)
    return()
  endif()
  string(REGEX REPLACE "^${side}_" "" rest ${name})
  if(NOT below)
    set(below ${rest})
  endif()
  if(NOT side STREQUAL common)
    set(below ${side}/${below})
  endif()
  set(${root} ${CMAKE_CURRENT_SOURCE_DIR} PARENT_SCOPE)
  set(${folder} forcebound/${below} PARENT_SCOPE)
endfunction()
