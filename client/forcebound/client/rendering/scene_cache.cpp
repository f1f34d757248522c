#include "forcebound/client/rendering/scene_cache.hpp"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "forcebound/text/printable.hpp"

namespace forcebound::client {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".scene";
// Read at once.
constexpr std::size_t kBlockBytes = std::size_t{1} << 20U;

std::string reason() { return std::generic_category().message(errno); }

/// A scene, HASH.scene, or what a program that was killed left of one, HASH.scene.new-PID.
bool is_of_the_cache(const fs::path& path) {
  const std::string name = path.filename().string();
  const std::size_t digits = name.find_first_not_of("0123456789abcdef");
  if (digits != 2 * sizeof(handover::Hash)) return false;
  const std::string ending = name.substr(digits);
  return ending == kEnding || ending.starts_with(std::string(kEnding) + ".new-");
}

/// False if it is there already, also as a link, or not all of it can be written.
bool write_new(const std::string& file, const std::vector<std::byte>& content) {
  constexpr ::mode_t kForOwner = 0600;
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kForOwner);
  if (out < 0) return false;
  std::size_t done = 0;
  while (done < content.size()) {
    const ::ssize_t more = ::write(out, content.data() + done, content.size() - done);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    done += static_cast<std::size_t>(more);
  }
  const int problem = errno;
  const bool closed = ::close(out) == 0;
  if (done < content.size()) errno = problem;
  return closed && done == content.size();
}

}  // namespace

SceneCache::SceneCache(std::string folder, std::uintmax_t bytes_max)
    : folder_(std::move(folder)), bytes_max_(bytes_max) {}

std::string SceneCache::file_of(const handover::Hash& hash) const {
  return (fs::path(folder_) / (handover::to_text(hash) + std::string(kEnding))).string();
}

void SceneCache::store_problem(const std::string& problem) {
  if (problem_.empty()) problem_ = problem;
}

std::optional<std::vector<std::byte>> SceneCache::load(const handover::Hash& hash, const std::stop_token& ended) {
  if (folder_.empty()) return std::nullopt;
  const std::string file = file_of(hash);
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > bytes_max_) return std::nullopt;
  std::vector<std::byte> content(bytes);
  std::ifstream in(file, std::ios::binary);
  std::size_t done = 0;
  while (in && done < content.size()) {
    if (ended.stop_requested()) return std::nullopt;
    const std::size_t more = std::min(kBlockBytes, content.size() - done);
    in.read(reinterpret_cast<char*>(content.data() + done), static_cast<std::streamsize>(more));
    done += static_cast<std::size_t>(in.gcount());
  }
  if (done == content.size()) return content;
  store_problem("scene cache: " + file + " cannot be read: " + reason());
  return std::nullopt;
}

void SceneCache::store(const handover::Hash& hash, const std::vector<std::byte>& content,
                       const std::stop_token& ended) {
  if (folder_.empty() || content.size() > bytes_max_) return;
  std::error_code error;
  if (fs::create_directories(folder_, error)) fs::permissions(folder_, fs::perms::owner_all, error);
  make_room_for(content.size(), ended);
  if (ended.stop_requested()) return;
  const std::string file = file_of(hash);
  const std::string successor = file + ".new-" + std::to_string(::getpid());
  ::unlink(successor.c_str());  // of a program of the same number that was killed
  if (write_new(successor, content) && ::rename(successor.c_str(), file.c_str()) == 0) return;
  store_problem("scene cache: " + text::printable(file) + ": cannot be written: " + reason());
  ::unlink(successor.c_str());
}

void SceneCache::store_mismatch(const handover::Hash& hash) {
  store_problem("scene cache: " + text::printable(file_of(hash)) +
                " is not what the server announces and was not used");
}

void SceneCache::make_room_for(std::uintmax_t bytes, const std::stop_token& ended) {
  struct File {
    fs::file_time_type written;
    std::uintmax_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uintmax_t all = bytes;
  std::error_code error;
  fs::directory_iterator entry(folder_, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (ended.stop_requested()) return;
    // Another client may remove a file meanwhile.
    std::error_code gone;
    if (!is_of_the_cache(entry->path()) || !entry->is_regular_file(gone)) continue;
    const File file{entry->last_write_time(gone), entry->file_size(gone), entry->path()};
    if (gone) continue;
    files.push_back(file);
    all += file.bytes;
  }
  std::ranges::sort(files, {}, &File::written);
  for (const File& file : files) {
    if (all <= bytes_max_ || ended.stop_requested()) return;
    if (fs::remove(file.path, error)) all -= file.bytes;
  }
}

}  // namespace forcebound::client
