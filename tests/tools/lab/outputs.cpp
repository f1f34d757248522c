#include "tests/tools/lab/outputs.hpp"

#include <stdexcept>
#include <system_error>

#include "forcebound/text/file.hpp"
#include "tests/tools/lab/figures/draw.hpp"
#include "tests/tools/lab/option_checks.hpp"

namespace forcebound::lab {
namespace {

namespace fs = std::filesystem;

/// Devices and pipes can be written twice.
bool may_be_shared(const std::string& file) { return fs::exists(file) && !fs::is_regular_file(file); }

void expect_each_its_own(const std::vector<std::string>& inputs, const std::vector<std::string>& written) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (written[i].empty() || may_be_shared(written[i])) continue;
    for (const std::string& input : inputs) {
      if (input.empty() || !fs::exists(input) || !is_same_path(input, written[i])) continue;
      throw std::invalid_argument(written[i] + ": would be replaced, but is read: give the output another name");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (written[k].empty() || !is_same_path(written[k], written[i])) continue;
      throw std::invalid_argument(written[i] + ": would be written twice: give one of the outputs another name");
    }
  }
}

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return;
  throw std::runtime_error("cannot create the directory '" + folder.string() + "' for figures: " + error.message());
}

}  // namespace

std::vector<fs::path> pictures_in(const std::string& folder, const std::vector<std::string>& names) {
  std::vector<fs::path> pictures;
  if (folder.empty()) return pictures;
  pictures.reserve(names.size());
  for (const std::string& name : names) pictures.push_back(fs::path(folder) / name);
  return pictures;
}

void prepare(const Outputs& outputs) {
  std::vector<std::string> written = outputs.files;
  written.push_back(outputs.page);
  expect_each_its_own(outputs.inputs, written);
  if (!outputs.folder.empty()) create_folder(outputs.folder);
  if (!outputs.page.empty()) (void)page_with(outputs.page, outputs.marks, "");
  for (const std::string& file : written) {
    if (!file.empty()) text::expect_writable(file);
  }
  written.insert(written.end(), outputs.inputs.begin(), outputs.inputs.end());
  for (const fs::path& figure : outputs.figures) {
    if (!figure.empty()) expect_drawable(figure, written);
  }
}

std::string page_with(const std::string& file, const Marks& marks, std::string_view part) {
  const std::string document = text::read_file(file);
  try {
    return with_between_marks(document, marks, part);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace forcebound::lab
