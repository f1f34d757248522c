include(CMakePackageConfigHelpers)

option(FORCEBOUND_INSTALL "Add Forcebound's install rules" ${PROJECT_IS_TOP_LEVEL})
set(FORCEBOUND_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Forcebound)

# How a consumer finds the packages that a component links, by the namespace of the linked target.
set(FORCEBOUND_PACKAGE_Eigen3 Eigen3)
set(FORCEBOUND_PACKAGE_Sodium Sodium)
set(FORCEBOUND_PACKAGE_Threads Threads)
set(FORCEBOUND_PACKAGE_ZLIB ZLIB)
set(FORCEBOUND_PACKAGE_assimp assimp)
set(FORCEBOUND_PACKAGE_mujoco mujoco)
set(FORCEBOUND_PACKAGE_nlohmann_json nlohmann_json)
set(FORCEBOUND_PACKAGE_protobuf Protobuf)
set(FORCEBOUND_PACKAGE_spdlog spdlog)
set(FORCEBOUND_PACKAGE_tinyxml2 tinyxml2)
set(FORCEBOUND_PACKAGE_tomlplusplus tomlplusplus)
set(FORCEBOUND_PACKAGE_zstd zstd)

# forcebound_component(NAME [LINKED ...]): installs the library NAME and what find_package(Forcebound COMPONENTS NAME)
# needs.
function(forcebound_component name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LINKED")
  install(TARGETS forcebound_${name} EXPORT forcebound_${name}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name})
  install(EXPORT forcebound_${name} NAMESPACE forcebound:: FILE Forcebound-${name}.cmake
          DESTINATION ${FORCEBOUND_CMAKE_DIR} COMPONENT ${name})

  foreach(linked IN LISTS arg_LINKED)
    if(linked MATCHES "^forcebound::(.+)$")
      set_property(GLOBAL APPEND PROPERTY FORCEBOUND_${name}_COMPONENTS ${CMAKE_MATCH_1})
    elseif(linked MATCHES "^([A-Za-z0-9_]+)::")
      set(package ${FORCEBOUND_PACKAGE_${CMAKE_MATCH_1}})
      if(NOT package)
        message(FATAL_ERROR "forcebound::${name} links ${linked}: say in ForceboundInstall.cmake which package has it")
      endif()
      set_property(GLOBAL APPEND PROPERTY FORCEBOUND_${name}_PACKAGES ${package})
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY FORCEBOUND_COMPONENTS ${name})
endfunction()

# All that NAME needs, directly or not, before NAME itself.
function(forcebound_closure name result)
  set(closure)
  get_property(needed GLOBAL PROPERTY FORCEBOUND_${name}_COMPONENTS)
  foreach(other IN LISTS needed)
    forcebound_closure(${other} before)
    list(APPEND closure ${before})
  endforeach()
  list(APPEND closure ${name})
  list(REMOVE_DUPLICATES closure)
  set(${result} ${closure} PARENT_SCOPE)
endfunction()

# forcebound_install_package(): ForceboundConfig.cmake and its version, after every component is known.
function(forcebound_install_package)
  get_property(components GLOBAL PROPERTY FORCEBOUND_COMPONENTS)
  set(FORCEBOUND_FACTS "set(_forcebound_components ${components})\n")
  foreach(name IN LISTS components)
    forcebound_closure(${name} closure)
    set(packages)
    foreach(part IN LISTS closure)
      get_property(needed GLOBAL PROPERTY FORCEBOUND_${part}_PACKAGES)
      list(APPEND packages ${needed})
    endforeach()
    list(REMOVE_DUPLICATES packages)
    string(APPEND FORCEBOUND_FACTS "set(_forcebound_parts_of_${name} ${closure})\n"
                                   "set(_forcebound_packages_of_${name} ${packages})\n")
  endforeach()
  configure_package_config_file(${PROJECT_SOURCE_DIR}/deploy/cmake/ForceboundConfig.cmake.in
                                ${PROJECT_BINARY_DIR}/ForceboundConfig.cmake INSTALL_DESTINATION ${FORCEBOUND_CMAKE_DIR}
                                NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/ForceboundConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  # With each, so that one that is installed alone is found.
  foreach(name IN LISTS components)
    install(FILES ${PROJECT_BINARY_DIR}/ForceboundConfig.cmake ${PROJECT_BINARY_DIR}/ForceboundConfigVersion.cmake
                  ${PROJECT_SOURCE_DIR}/deploy/cmake/FindSodium.cmake
            DESTINATION ${FORCEBOUND_CMAKE_DIR} COMPONENT ${name})
  endforeach()
endfunction()
