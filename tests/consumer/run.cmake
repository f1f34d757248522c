# Builds a consumer's project, with Forcebound installed from BINARY_DIR (its COMPONENTS, separated by
# commas, or all of them) or else with its sources, and runs PROGRAM of it, if one is named.
#   cmake -D CONSUMER_DIR=... -D WORK_DIR=... -D COMPILER=... -D LAUNCHER=... -D SOURCE_DIR=...
#         [-D BINARY_DIR=... [-D COMPONENTS=...]] [-D PROGRAM=...] -P run.cmake
file(REMOVE_RECURSE ${WORK_DIR})

if(BINARY_DIR)
  set(install ${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${WORK_DIR}/prefix)
  if(COMPONENTS)
    string(REPLACE "," ";" COMPONENTS ${COMPONENTS})
    foreach(component IN LISTS COMPONENTS)
      execute_process(COMMAND ${install} --component ${component} COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
  else()
    execute_process(COMMAND ${install} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endif()
  set(forcebound -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
else()
  set(forcebound -D FORCEBOUND_SOURCE=${SOURCE_DIR})
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR} -B ${WORK_DIR}/build ${forcebound}
                        -D SOURCE_TREE=${SOURCE_DIR}
                        -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} --no-warn-unused-cli
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build --parallel 2 COMMAND_ERROR_IS_FATAL ANY)
if(PROGRAM)
  execute_process(COMMAND ${WORK_DIR}/build/${PROGRAM} COMMAND_ERROR_IS_FATAL ANY)
endif()
