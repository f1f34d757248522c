#include "forcebound/law_plugin/known_laws.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/driver/crash.hpp"
#include "forcebound/law_plugin/plugin_law.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::law_plugin {
namespace {

/// Of the process, as libraries are: a law that was loaded keeps its name.
struct Loaded {
  std::mutex lock;
  std::vector<std::shared_ptr<const LawLibrary>> libraries;
};
Loaded& loaded() {
  static Loaded only;
  return only;
}

bool is_path(const std::string& text) { return text.find('/') != std::string::npos || text.ends_with(".so"); }

std::optional<std::string> file_of(const std::string& name_or_file) {
  if (is_path(name_or_file)) return name_or_file;
  return driver::find_plugin(
      kLaws, name_or_file,
      driver::plugin_folders(kLaws, std::getenv("FORCEBOUND_LAW_PATH"), text::program_path().string()));
}

/// With the lock held.
std::string name_of_library(const std::string& file, std::vector<std::shared_ptr<const LawLibrary>>& libraries) {
  for (const auto& library : libraries) {
    if (text::is_same_path(library->file(), file)) return library->functions().name;
  }
  auto library = std::make_shared<const LawLibrary>(file);
  const std::string name = library->functions().name;
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error("law " + file + ": calls itself '" + name + "', as " + why);
  };
  const std::vector<std::string> shipped = baselines::shipped_laws().names();
  if (std::ranges::find(shipped, name) != shipped.end()) refuse("one that ships; give it another name");
  const auto same = std::ranges::find(libraries, name, [](const auto& other) { return other->functions().name; });
  if (same != libraries.end()) refuse((*same)->file() + " does");
  libraries.push_back(std::move(library));
  return name;
}

}  // namespace

control::LawRegistry known_laws() {
  control::LawRegistry laws = baselines::shipped_laws();
  const std::scoped_lock alone(loaded().lock);
  for (const auto& library : loaded().libraries) laws.add(described(library));
  return laws;
}

std::string law_named(const std::string& name_or_file) {
  const std::vector<std::string> known = known_laws().names();
  if (std::ranges::find(known, name_or_file) != known.end()) return name_or_file;
  const auto file = file_of(name_or_file);
  if (!file) {
    throw std::invalid_argument("unknown law '" + name_or_file + "'" + text::suggestion(name_or_file, known));
  }
  try {
    const std::scoped_lock alone(loaded().lock);
    return name_of_library(*file, loaded().libraries);
  } catch (const std::runtime_error& refused) {
    throw std::invalid_argument(refused.what());
  }
}

std::string law_of_option(const std::string& name_or_file) {
  const std::vector<std::string> known = known_laws().names();
  if (std::ranges::find(known, name_or_file) == known.end()) driver::catch_crashes();
  return law_named(name_or_file);
}

}  // namespace forcebound::law_plugin
