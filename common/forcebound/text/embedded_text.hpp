#pragma once

#include <string_view>

namespace forcebound::text {

/// A text file that was built into a library (deploy/cmake/EmbedTexts.cmake).
struct EmbeddedText {
  std::string_view name;  ///< the file's, without folder and extension
  std::string_view text;
};

}  // namespace forcebound::text
