#include "forcebound/text/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "forcebound/text/printable.hpp"

namespace forcebound::text {
namespace {

namespace fs = std::filesystem;

constexpr ::mode_t kForAll = 0666;  // less the umask
/// What is read of a device or a pipe at the most, since these may go on without end.
constexpr std::size_t kBytesMost = std::size_t{256} << 20;

[[noreturn]] void refuse_reading(const std::string& path, const std::string& why) {
  throw std::runtime_error(printable(path) + ": cannot be read: " + why);
}

[[noreturn]] void refuse_writing(const std::string& path, const std::string& why) {
  throw std::runtime_error(printable(path) + ": cannot be written: " + why);
}

std::error_code last_error() { return {errno != 0 ? errno : EIO, std::generic_category()}; }

/// Creates an empty file where there is none. @returns what failed
std::error_code create(const std::string& path, ::mode_t permissions) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions);
  if (file < 0) return last_error();
  ::close(file);
  return {};
}

/// @returns what failed
std::error_code put(const std::string& path, std::string_view content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  return file ? std::error_code() : last_error();
}

/// Creates an empty file that can take the place of what is at `path`: of the same owner, group and permissions.
/// @returns whether there is one. None takes the place of a link, of a protected file, or of one with several names.
bool create_successor(const std::string& path, const std::string& successor) {
  constexpr ::mode_t kPermissions = 07777;
  struct ::stat before {};
  if (::lstat(path.c_str(), &before) != 0) return errno == ENOENT && !create(successor, kForAll);
  if (!S_ISREG(before.st_mode) || before.st_nlink != 1 || ::access(path.c_str(), W_OK) != 0) return false;
  if (create(successor, before.st_mode & kPermissions)) return false;
  struct ::stat made {};
  const bool same_owner =
      ::lstat(successor.c_str(), &made) == 0 && made.st_uid == before.st_uid && made.st_gid == before.st_gid;
  // What the umask took.
  if (same_owner && ::chmod(successor.c_str(), before.st_mode & kPermissions) == 0) return true;
  ::unlink(successor.c_str());
  return false;
}

/// The file that a link, or a chain of them, leads to; there or not yet.
fs::path end_of_links(fs::path path) {
  constexpr int kMost = 40;  // as in Linux
  std::error_code ignored;
  for (int i = 0; i < kMost && fs::is_symlink(path, ignored); ++i) {
    path = path.parent_path() / fs::read_symlink(path, ignored);
  }
  return path;
}

}  // namespace

std::string read_file(const std::string& path) {
  // Opening a directory succeeds; only reading it would fail.
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) refuse_reading(path, "it is a directory");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse_reading(path, last_error().message());
  const bool may_be_endless = is_special_file(path);
  std::string text;
  std::array<char, 1 << 16> part{};
  while (file) {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
    if (may_be_endless && text.size() > kBytesMost) {
      refuse_reading(path, "it is no regular file and has more than " + std::to_string(kBytesMost >> 20) + " MiB");
    }
  }
  if (file.bad()) refuse_reading(path, last_error().message());
  return text;
}

void write_file(const std::string& path, std::string_view content) {
  const std::string successor = path + ".new-" + std::to_string(::getpid());
  if (create_successor(path, successor)) {
    const std::error_code error = put(successor, content);
    if (!error && ::rename(successor.c_str(), path.c_str()) == 0) return;
    ::unlink(successor.c_str());
    if (error) refuse_writing(path, error.message());
  }
  // Nothing can take its place, such as of a device, a link, or a file mounted on its own.
  if (const std::error_code error = put(path, content)) refuse_writing(path, error.message());
}

void expect_writable(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) refuse_writing(path, "it is a directory");
  // Not opened: a pipe would wait for its reader.
  if (::access(path.c_str(), W_OK) == 0) return;
  if (errno != ENOENT) refuse_writing(path, last_error().message());
  const std::string end = end_of_links(path).string();
  const std::error_code error = create(end, kForAll);
  if (!error) {
    ::unlink(end.c_str());
  } else if (error != std::errc::file_exists || ::access(path.c_str(), W_OK) != 0) {  // another may have just made it
    refuse_writing(path, error.message());
  }
}

bool is_special_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
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
