#include "forcebound/text/file.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "forcebound/text/internal/file_problems.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::text {

namespace fs = std::filesystem;

void refuse_reading(const std::string& path, const std::string& why) {
  throw std::runtime_error(printable(path) + ": cannot be read: " + why);
}

std::string not_writable(const std::string& path, const std::string& why) {
  return printable(path) + ": cannot be written: " + why;
}

void refuse_writing(const std::string& path, const std::string& why) {
  throw std::runtime_error(not_writable(path, why));
}

fs::path end_of_links(fs::path path) {
  constexpr int kMost = 40;  // as in Linux
  std::error_code ignored;
  for (int i = 0; i < kMost && fs::is_symlink(path, ignored); ++i) {
    path = path.parent_path() / fs::read_symlink(path, ignored);
  }
  return path;
}

namespace {

/// Where a path leads, there or not yet. @throws std::runtime_error
fs::path end_of(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  const fs::path end = error ? fs::path() : fs::weakly_canonical(absolute, error);
  if (error) refuse_reading(path.string(), error.message());
  return end;
}

/// Both as end_of returns them.
bool is_below(fs::path path, fs::path folder) {
  for (fs::path* of : {&path, &folder}) {
    if (!of->has_filename()) *of = of->parent_path();  // it ends with a slash
  }
  const auto [in_folder, in_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return in_folder == folder.end() && in_path != path.end();
}

}  // namespace

bool is_special_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

std::string path_within(const std::string& named, const std::string& folder, std::span<const std::string> others) {
  const fs::path path = fs::path(folder) / named;
  // The system would take what is before it for the whole path.
  if (named.find('\0') != std::string::npos) refuse_reading(path.string(), "its name has a zero byte");
  const fs::path end = end_of(path);
  std::string allowed = "'" + printable(folder.empty() ? "." : folder) + "'";
  bool within = is_below(end, end_of(folder.empty() ? "." : folder));
  for (const std::string& other : others) {
    within = within || is_below(end, end_of(other));
    allowed += " or '" + printable(other) + "'";
  }
  if (within) return path.string();
  throw std::runtime_error(printable(path.string()) + ": lies outside of " + allowed +
                           ", where the files must be that this one names");
}

bool is_same_path(const fs::path& one, const fs::path& other) {
  std::error_code ignored;
  if (fs::equivalent(one, other, ignored)) return true;
  const auto whole = [&](const fs::path& path) {
    const fs::path absolute = fs::absolute(end_of_links(path), ignored);
    const fs::path canonical = fs::weakly_canonical(absolute, ignored);
    return canonical.empty() ? absolute : canonical;
  };
  return whole(one) == whole(other);
}

}  // namespace forcebound::text
