#include "forcebound/results/outputs.hpp"

#include <stdexcept>
#include <system_error>

#include "forcebound/results/draw.hpp"
#include "forcebound/text/file.hpp"

namespace forcebound::results {
namespace {

namespace fs = std::filesystem;

bool is_there(const std::string& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

void expect_each_its_own(const std::vector<std::string>& inputs, const std::vector<std::string>& written) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (written[i].empty() || text::is_special_file(written[i])) continue;
    for (const std::string& input : inputs) {
      if (input.empty() || !is_there(input) || !text::is_same_path(input, written[i])) continue;
      throw std::invalid_argument(written[i] + ": would be replaced, but is read: give the output another name");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (written[k].empty() || !text::is_same_path(written[k], written[i])) continue;
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

/// The folder and those above it that are not there, the innermost first.
std::vector<fs::path> missing_folders(fs::path folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (; !folder.empty() && !fs::exists(folder, ignored); folder = folder.parent_path()) missing.push_back(folder);
  return missing;
}

/// @param written the files and the page
void expect_all_writable(const Outputs& outputs, const std::vector<std::string>& written) {
  if (!outputs.page.empty()) (void)page_with(outputs.page, outputs.marks, "");
  for (const std::string& file : written) {
    if (!file.empty()) text::expect_writable(file);
  }
  std::vector<std::string> kept = written;
  kept.insert(kept.end(), outputs.inputs.begin(), outputs.inputs.end());
  for (const fs::path& figure : outputs.figures) {
    if (!figure.empty()) expect_drawable(figure, kept, outputs.formats);
  }
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
  const std::vector<fs::path> missing = missing_folders(outputs.folder);
  try {
    if (!outputs.folder.empty()) create_folder(outputs.folder);
    expect_all_writable(outputs, written);
  } catch (...) {
    std::error_code ignored;
    for (const fs::path& folder : missing) fs::remove(folder, ignored);
    throw;
  }
}

std::string page_with(const std::string& file, const text::Marks& marks, std::string_view part) {
  const std::string document = text::read_file(file);
  try {
    return text::with_between_marks(document, marks, part);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace forcebound::results
