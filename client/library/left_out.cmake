# library_left_out(FILE SOURCE...): FILE defines each function of forcebound.h that no SOURCE defines: it refuses, or, if it
# returns nothing, does nothing. So a new function of the header needs nothing here.
function(library_left_out file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS forcebound.h ${ARGN})
  set(defined "")
  foreach(source IN LISTS ARGN)
    file(READ ${source} text)
    string(APPEND defined "${text}")
  endforeach()
  file(READ forcebound.h header)
  string(REGEX MATCHALL "\nFB_EXPORT [^()]+\\([^()]*\\)" declarations "${header}")
  set(functions "")
  foreach(declaration IN LISTS declarations)
    string(REGEX MATCH "\nFB_EXPORT (([^(]+)(fb_[a-z_]+))(.+)" whole "${declaration}")
    string(FIND "${defined}" "\n${CMAKE_MATCH_1}(" place)
    if(place EQUAL -1)
      if(CMAKE_MATCH_2 STREQUAL "void ")
        set(body "")
      else()
        set(body "return left_out(\"${CMAKE_MATCH_3}\");")
      endif()
      string(APPEND functions "${CMAKE_MATCH_1}${CMAKE_MATCH_4} { ${body} }\n")
    endif()
  endforeach()
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT "#include \"library/source/errors.hpp\"

static fb_status left_out(const char* function) noexcept {
  return forcebound::library::refused(
      function, \"this library is for Windows and has laws alone; devices, client and server are in that for Linux\",
      FB_FAILED);
}

${functions}")
  set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS -Wno-unused-parameter)
endfunction()
