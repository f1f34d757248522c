#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/text/marks.hpp"

namespace forcebound::results {

/// What a command writes. Empty names are no files.
struct Outputs {
  std::vector<std::string> inputs{};  ///< what it reads; nothing may replace it
  std::vector<std::string> files{};
  std::string page{};                            ///< a document of which the part between `marks` is replaced
  text::Marks marks{};                           ///< of the page
  std::string folder{};                          ///< of its figures
  std::vector<std::filesystem::path> figures{};  ///< FILE.png, each with data and script beside it
  std::vector<std::string> formats{};            ///< of further pictures of each figure
};

/// The pictures of such names in a folder; none if the folder has no name.
[[nodiscard]] std::vector<std::filesystem::path> pictures_in(const std::string& folder,
                                                             const std::vector<std::string>& names);

/// To be called before a command's work: creates the folder of its figures, and checks that everything can be written,
/// that the page has its marks, and that no output replaces another, an input, or anything that an earlier figure did
/// not leave. Where it refuses, it leaves no new folder.
/// @throws std::invalid_argument for options that do not go together, std::runtime_error for anything else, naming the
/// file
void prepare(const Outputs& outputs);

/// A document with the part between its marks replaced. @throws std::runtime_error naming the file
[[nodiscard]] std::string page_with(const std::string& file, const text::Marks& marks, std::string_view part);

}  // namespace forcebound::results
