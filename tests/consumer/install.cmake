# Installs Forcebound from BINARY_DIR and configures consumers' projects with what is installed, in WORK_DIR/build.
#   cmake -D PROJECTS=PROJECT[:COMPONENT:COMPONENT...],... -D CONSUMER_DIR=... -D WORK_DIR=... -D COMPILER=...
#         -D LAUNCHER=... -D SOURCE_DIR=... -D BINARY_DIR=... -P install.cmake
# A project for which components are named finds these alone.
file(REMOVE_RECURSE ${WORK_DIR})
set(prefixes ${WORK_DIR}/prefix)
set(install ${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix)
execute_process(COMMAND ${install} ${prefixes}/all OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

set(names)
string(REPLACE "," ";" projects ${PROJECTS})
foreach(project IN LISTS projects)
  string(REPLACE ":" ";" components ${project})
  list(POP_FRONT components name)
  list(APPEND names ${name})
  foreach(component IN LISTS components)
    execute_process(COMMAND ${install} ${prefixes}/${name} --component ${component} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()
list(JOIN names "," names)

execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR}/together -B ${WORK_DIR}/build
                        -D PROJECTS=${names} -D PREFIXES=${prefixes} -D SOURCE_TREE=${SOURCE_DIR}
                        -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
                        --no-warn-unused-cli
                COMMAND_ERROR_IS_FATAL ANY)
