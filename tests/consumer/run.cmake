# Builds and runs the stranger's project, with Forcebound installed from BINARY_DIR or else with its sources.
#   cmake -D STRANGER_DIR=... -D WORK_DIR=... -D COMPILER=... -D LAUNCHER=... (-D BINARY_DIR=... | -D SOURCE_DIR=...) -P run.cmake
file(REMOVE_RECURSE ${WORK_DIR})

if(BINARY_DIR)
  foreach(component control package)
    execute_process(COMMAND ${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${WORK_DIR}/prefix --component ${component}
                    COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  set(forcebound -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
else()
  set(forcebound -D FORCEBOUND_SOURCE=${SOURCE_DIR})
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${STRANGER_DIR} -B ${WORK_DIR}/build ${forcebound}
                        -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK_DIR}/build/bound_a_wall COMMAND_ERROR_IS_FATAL ANY)
