# What is built for the system that it is built for: on Linux all of it.

if(NOT WIN32)
  return()
endif()
# For Windows the law half of the C library (client/library), and of the libraries what that needs; the others are left out.
set(FORCEBOUND_ONLY text time control config baselines device)
foreach(name FORCEBOUND_WITH_MUJOCO FORCEBOUND_FLEET FORCEBOUND_ROBOT FORCEBOUND_PYTHON FORCEBOUND_PAGE)
  option(${name} "Not for Windows" OFF)
  if(${name})
    message(FATAL_ERROR "${name}=${${name}}: expected OFF, since for Windows the C library's laws alone are built")
  endif()
endforeach()
