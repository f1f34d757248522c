# forcebound_embed_texts(TARGET NAMESPACE VARIABLE FILES...): builds text files into a library, so that an installed program
# needs no files beside it.
#
# The target's sources may `#include "embedded/VARIABLE.hpp"`, which declares
#
#     namespace NAMESPACE {
#     struct EmbeddedText { std::string_view name, text; };   // name: the file's name without folder and extension
#     std::span<const EmbeddedText> VARIABLE() noexcept;      // in the order of FILES
#     }
#
# A changed file is embedded again by the next build. Call it once per namespace.
function(forcebound_embed_texts target namespace variable)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(entries "")
  foreach(file IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    cmake_path(GET file STEM LAST_ONLY name)
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  list(LENGTH ARGN count)
  _forcebound_write_if_different(${folder}/${variable}.hpp "#pragma once

#include <span>
#include <string_view>

namespace ${namespace} {
struct EmbeddedText {
  std::string_view name;
  std::string_view text;
};
std::span<const EmbeddedText> ${variable}() noexcept;
}  // namespace ${namespace}
")
  _forcebound_write_if_different(${folder}/${variable}.cpp "#include \"embedded/${variable}.hpp\"

#include <array>

namespace ${namespace} {
namespace {
constexpr std::array<EmbeddedText, ${count}> kTexts{{
${entries}}};
}  // namespace
std::span<const EmbeddedText> ${variable}() noexcept { return kTexts; }
}  // namespace ${namespace}
")
  target_sources(${target} PRIVATE ${folder}/${variable}.cpp)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()

# Leaves the file's time alone where nothing changed, so that nothing is rebuilt.
function(_forcebound_write_if_different path text)
  file(WRITE ${path}.new "${text}")
  file(COPY_FILE ${path}.new ${path} ONLY_IF_DIFFERENT)
  file(REMOVE ${path}.new)
endfunction()
