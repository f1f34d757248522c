#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>

#include "forcebound/text/file.hpp"
#include "forcebound/text/internal/file_problems.hpp"

namespace forcebound::text {
namespace {

namespace fs = std::filesystem;

constexpr ::mode_t kForAll = 0666;  // less the umask

std::error_code last_error() { return {errno != 0 ? errno : EIO, std::generic_category()}; }

/// A file's descriptor, closed at the end.
struct Opened {
  int descriptor;
  explicit Opened(int opened) noexcept : descriptor(opened) {}
  ~Opened() {
    if (descriptor >= 0) ::close(descriptor);
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
};

/// @returns how many bytes were read; 0 at the end
std::size_t read_some(int descriptor, std::span<char> into, const std::string& path) {
  while (true) {
    const ssize_t bytes = ::read(descriptor, into.data(), into.size());
    if (bytes >= 0) return static_cast<std::size_t>(bytes);
    if (errno != EINTR) refuse_reading(path, last_error().message());
  }
}

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

}  // namespace

std::string read_file(const std::string& path, std::size_t bytes_most) {
  // A pipe without a writer would block an open that waits for one.
  const Opened file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
  if (file.descriptor < 0) refuse_reading(path, last_error().message());
  struct ::stat facts {};
  if (::fstat(file.descriptor, &facts) != 0) refuse_reading(path, last_error().message());
  if (S_ISDIR(facts.st_mode)) refuse_reading(path, "it is a directory");
  if (!S_ISREG(facts.st_mode)) refuse_reading(path, "it is no regular file");
  const auto too_large = [&] {
    refuse_reading(path, "it has more than " + std::to_string(bytes_most) + " bytes, expected at most that");
  };
  if (facts.st_size > 0 && static_cast<std::uintmax_t>(facts.st_size) > bytes_most) too_large();
  std::string text;
  text.reserve(static_cast<std::size_t>(facts.st_size));
  std::array<char, 1 << 16> part{};
  // To the end, wherever that is by now: files of the system have more than their size says.
  while (const std::size_t bytes = read_some(file.descriptor, part, path)) {
    if (bytes > bytes_most - text.size()) too_large();
    text.append(part.data(), bytes);
  }
  return text;
}

void write_file(const std::string& path, std::string_view content) {
  const std::string successor = path + ".new-" + std::to_string(::getpid());
  if (create_successor(path, successor)) {
    const std::error_code error = put(successor, content);
    if (!error && ::rename(successor.c_str(), path.c_str()) == 0) return;
    ::unlink(successor.c_str());
    if (error) throw WriteError(not_writable(path, error.message()));
  }
  // Nothing can take its place, such as of a device, a link, or a file mounted on its own.
  if (const std::error_code error = put(path, content)) throw WriteError(not_writable(path, error.message()));
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

fs::path program_path() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored);
}

}  // namespace forcebound::text
