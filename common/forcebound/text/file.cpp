#include "forcebound/text/file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace forcebound::text {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_writing(const std::string& path, const std::string& why) {
  throw std::runtime_error(path + ": cannot be written: " + why);
}

/// Whether a new file can take its place: not that of a link, and not that of a protected file.
bool may_be_replaced(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(path, ignored);
  const bool there = status.type() == fs::file_type::regular;
  if (!there && status.type() != fs::file_type::not_found) return false;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : ".";
  return ::access(folder.c_str(), W_OK) == 0 && (!there || ::access(path.c_str(), W_OK) == 0);
}

/// @returns what failed
std::error_code put(const std::string& path, std::string_view content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file.write(content.data(), static_cast<std::streamsize>(content.size())).flush()) return {};
  return {errno != 0 ? errno : EIO, std::generic_category()};
}

}  // namespace

std::string read_file(const std::string& path) {
  // Opening a directory succeeds; only reading it would fail, and silently.
  if (std::filesystem::is_directory(path)) throw std::runtime_error(path + ": cannot be read: it is a directory");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (!file) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  return text;
}

void write_file(const std::string& path, std::string_view content) {
  const bool replaced = may_be_replaced(path);
  const std::string written = replaced ? path + ".new-" + std::to_string(::getpid()) : path;
  std::error_code error = put(written, content);
  if (replaced) {
    std::error_code ignored;
    const fs::file_status before = fs::status(path, ignored);
    if (fs::exists(before)) fs::permissions(written, before.permissions(), ignored);
    if (!error) fs::rename(written, path, error);
    if (error) fs::remove(written, ignored);
  }
  if (error) refuse_writing(path, error.message());
}

void expect_writable(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) refuse_writing(path, "it is a directory");
  if (fs::exists(path, ignored)) {
    // Not opened: a pipe would wait for its reader.
    if (::access(path.c_str(), W_OK) != 0) refuse_writing(path, std::strerror(errno));
    return;
  }
  const bool link = fs::is_symlink(path, ignored);
  if (const std::error_code error = put(path, "")) refuse_writing(path, error.message());
  if (!link) fs::remove(path, ignored);
}

}  // namespace forcebound::text
