# forcebound_embed_texts(TARGET HEADER FUNCTION PATTERN...): builds the text files that match into a library, so that an
# installed program needs no files beside it. HEADER declares FUNCTION, with its namespaces:
#
#     std::span<const text::EmbeddedText> FUNCTION() noexcept;      // by name: the file's, without folder and extension
#
# A changed file is embedded again by the next build.
function(forcebound_embed_texts target header function)
  if(FORCEBOUND_ONLY AND NOT TARGET ${target})
    return()
  endif()
  file(GLOB files CONFIGURE_DEPENDS ${ARGN})
  set(entries "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    cmake_path(GET file STEM LAST_ONLY name)
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  list(LENGTH files count)
  string(REGEX MATCH "(.*)::([^:]+)$" whole ${function})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${CMAKE_MATCH_2}.cpp)
  _forcebound_write_if_different(${source} "#include <array>

#include \"${header}\"

namespace ${CMAKE_MATCH_1} {
namespace {

constexpr std::array<text::EmbeddedText, ${count}> kTexts_${CMAKE_MATCH_2}{{
${entries}}};

}  // namespace

std::span<const text::EmbeddedText> ${CMAKE_MATCH_2}() noexcept { return kTexts_${CMAKE_MATCH_2}; }
}  // namespace ${CMAKE_MATCH_1}
")
  target_sources(${target} PRIVATE ${source})
endfunction()

# Leaves the file's time alone where nothing changed, so that nothing is rebuilt.
function(_forcebound_write_if_different path text)
  file(WRITE ${path}.new "${text}")
  file(COPY_FILE ${path}.new ${path} ONLY_IF_DIFFERENT)
  file(REMOVE ${path}.new)
endfunction()
