# cmake -DNPM=... -DFROM=... -DTO=... -P install_packages.cmake: the packages of FROM/package-lock.json into
# TO/node_modules.
file(SHA256 ${FROM}/package-lock.json wanted)
set(stamp ${TO}/node_modules/.forcebound-lock)
if(EXISTS ${stamp})
  file(READ ${stamp} installed)
  if(installed STREQUAL wanted)
    return()
  endif()
endif()
if(NOT NPM)
  message("SKIPPED: npm is not installed (Debian: apt-get install nodejs npm)")
  return()
endif()
file(COPY ${FROM}/package.json ${FROM}/package-lock.json DESTINATION ${TO})
# Ends before the test's own timeout, so that a dead network skips the test as well.
execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error WORKING_DIRECTORY ${TO}
                RESULT_VARIABLE result TIMEOUT 240)
if(NOT result EQUAL 0)
  message("SKIPPED: 'npm ci' failed: is the network there?")
  return()
endif()
file(WRITE ${stamp} ${wanted})
