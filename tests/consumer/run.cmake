# Builds a consumer's project and runs PROGRAM of it, if one is named.
#   cmake -D PROJECT=... -D WORK_DIR=... [-D PROGRAM=...] -P run.cmake
#     with what install.cmake has configured in WORK_DIR
#   cmake -D PROJECT=... -D WORK_DIR=... -D CONSUMER_DIR=... -D COMPILER=... -D LAUNCHER=... -D SOURCE_DIR=...
#         [-D PROGRAM=...] -P run.cmake
#     with Forcebound's sources
if(SOURCE_DIR)
  file(REMOVE_RECURSE ${WORK_DIR})
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR}/${PROJECT} -B ${WORK_DIR}/build
                          -D FORCEBOUND_SOURCE=${SOURCE_DIR}
                          -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
                  COMMAND_ERROR_IS_FATAL ANY)
  set(target all)
  set(programs ${WORK_DIR}/build)
else()
  set(target ${PROJECT}/all)
  set(programs ${WORK_DIR}/build/${PROJECT})
endif()

execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build --target ${target} --parallel 2
                COMMAND_ERROR_IS_FATAL ANY)
if(PROGRAM)
  execute_process(COMMAND ${programs}/${PROGRAM} COMMAND_ERROR_IS_FATAL ANY)
endif()
