# What is installed beside programs and libraries, and the Debian packages of it all: `cpack -G DEB`, which deploy/package
# runs.
#
#   forcebound         programs, drivers, scenes, devices, manual pages, completion
#   libforcebound1     the shared library with the C interface
#   libforcebound-dev  libraries, headers, CMake files, .proto files
#   python3-forcebound the Python package with its examples, for the Python that it was built with

# Without help2man, everything but the manual pages.
find_program(FORCEBOUND_HELP2MAN help2man)
mark_as_advanced(FORCEBOUND_HELP2MAN)

function(forcebound_man_pages)
  if(NOT FORCEBOUND_HELP2MAN)
    message(STATUS "Without help2man: no manual pages (Debian: apt-get install help2man)")
    return()
  endif()
  set(programs $<TARGET_FILE:forcebound>)
  set(names client server relay lab)
  if(FORCEBOUND_ROS2)
    list(APPEND names ros2)
  endif()
  foreach(name IN LISTS names)
    list(APPEND programs $<TARGET_FILE:forcebound-${name}>)
  endforeach()
  set(pages ${PROJECT_BINARY_DIR}/man)
  add_custom_command(OUTPUT ${pages}.stamp
                     COMMAND ${PROJECT_SOURCE_DIR}/deploy/packaging/man_pages ${PROJECT_BINARY_DIR}/bin ${pages}
                     COMMAND ${CMAKE_COMMAND} -E touch ${pages}.stamp
                     DEPENDS ${programs} ${PROJECT_SOURCE_DIR}/deploy/packaging/man_pages
                     COMMENT "Writing manual pages" VERBATIM)
  add_custom_target(man_pages ALL DEPENDS ${pages}.stamp)
  install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
endfunction()

# The rest of what a user of the programs gets.
function(forcebound_install_data)
  set(packaging ${PROJECT_SOURCE_DIR}/deploy/packaging)
  set(names forcebound forcebound-client forcebound-server forcebound-relay forcebound-lab)
  if(FORCEBOUND_ROS2)
    list(APPEND names forcebound-ros2)
  endif()
  foreach(name IN LISTS names)
    install(FILES ${packaging}/completion.bash RENAME ${name}
            DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
  endforeach()
  install(FILES ${packaging}/completion.zsh RENAME _forcebound
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT programs)
  # As services of systemd.
  set(units ${PROJECT_SOURCE_DIR}/deploy/systemd)
  install(FILES ${units}/forcebound-server.service ${units}/forcebound-server.socket DESTINATION lib/systemd/system
          COMPONENT programs)
  install(FILES ${units}/forcebound-client.service DESTINATION lib/systemd/user COMPONENT programs)
  install(FILES ${units}/forcebound.sysusers RENAME forcebound.conf DESTINATION lib/sysusers.d COMPONENT programs)
  install(FILES ${units}/server.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/forcebound/examples COMPONENT programs)
  # The programs have these within; here they are to be read, copied and changed.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/server/scenes ${PROJECT_SOURCE_DIR}/common/devices
          DESTINATION ${CMAKE_INSTALL_DATADIR}/forcebound COMPONENT programs FILES_MATCHING PATTERN "*.toml")
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/forcebound COMPONENT programs)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libforcebound-dev COMPONENT control)
endfunction()

set(CPACK_PACKAGE_NAME forcebound)
set(CPACK_PACKAGE_VENDOR "Forcebound developers")
set(CPACK_PACKAGE_CONTACT "Forcebound developers <maintainers@forcebound.example>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME forcebound)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/deploy/packaging/programs/postinst ${PROJECT_SOURCE_DIR}/deploy/packaging/programs/prerm)
# The figures; a machine without it gets the data and the script.
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION
" A client beside a haptic device, a server that simulates the virtual
 environment, a relay that emulates a bad network between them, tools of every
 day for devices, networks, keys and recordings, and a laboratory of
 experiments.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libforcebound1)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS forcebound)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
" Laws that bound a force, a client and a server of networked haptics, for
 programs in C and in languages that call C.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libforcebound-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
" Libraries for programs of your own: laws that bound a force, the client and the server of networked haptics, the
 interfaces of devices and environments: static libraries, headers and a CMake
 package with a component for each.")
# What the installed CMake package looks for; with static libraries shlibdeps finds none of it.
set(FORCEBOUND_DEBIAN_LIBRARIES libeigen3-dev libprotobuf-dev libspdlog-dev libtomlplusplus-dev nlohmann-json3-dev
    zlib1g-dev libzstd-dev libsodium-dev libassimp-dev)
if(FORCEBOUND_MUJOCO)
  list(APPEND FORCEBOUND_DEBIAN_LIBRARIES libmujoco-dev libqhull-dev libtinyxml2-dev libopengl-dev libglx-dev libgl-dev)
endif()
list(APPEND FORCEBOUND_DEBIAN_LIBRARIES "libforcebound1 (= ${PROJECT_VERSION})")
list(JOIN FORCEBOUND_DEBIAN_LIBRARIES ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-forcebound)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/deploy/packaging/python/postinst ${PROJECT_SOURCE_DIR}/deploy/packaging/python/prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS forcebound)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
" Laws that bound a force, networked haptics in virtual time, recordings as
 numpy's arrays and a client of a live server, from Python.")

# forcebound_packages(): after every component is known.
function(forcebound_packages)
  forcebound_man_pages()
  forcebound_install_data()
  get_property(libraries GLOBAL PROPERTY FORCEBOUND_COMPONENTS)
  set(CPACK_COMPONENTS_ALL programs c_runtime ${libraries})
  if(TARGET forcebound_python)
    list(APPEND CPACK_COMPONENTS_ALL python)
    # One Python's extension module is of no use to the next.
    get_property(version GLOBAL PROPERTY FORCEBOUND_PYTHON_VERSION)
    string(REPLACE "." ";" parts ${version})
    list(GET parts 0 major)
    list(GET parts 1 minor)
    math(EXPR next "${minor} + 1")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
        "python3 (>= ${major}.${minor}), python3 (<< ${major}.${next}), python3-numpy")
  endif()
  include(CPack)
  cpack_add_component_group(programs)
  cpack_add_component_group(development)
  cpack_add_component_group(runtime)
  cpack_add_component(programs GROUP programs)
  cpack_add_component(c_runtime GROUP runtime)
  if(TARGET forcebound_python)
    cpack_add_component_group(python)
    cpack_add_component(python GROUP python)
  endif()
  foreach(name IN LISTS libraries)
    cpack_add_component(${name} GROUP development)
  endforeach()
endfunction()
