#include "forcebound/driver/written_by_owner.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <stdexcept>

#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_writers(const std::string& who, const fs::path& what, const std::string& accepted) {
  throw std::runtime_error(who + " may write to " + text::printable(what.string()) +
                           ", so it may be anybody's code; accepted is what its owner alone may write: chmod " +
                           accepted + " " + text::printable(what.string()));
}

void expect_owner_writes(const fs::path& path) {
  struct ::stat about {};
  if (::stat(path.c_str(), &about) != 0) return;
  if ((about.st_mode & S_IWOTH) != 0) refuse_writers("everybody", path, "o-w");
  // Of the owner's own group, where new files are the group's too (umask 002), nobody else is.
  if ((about.st_mode & S_IWGRP) != 0 && about.st_gid != about.st_uid) {
    refuse_writers("group " + std::to_string(about.st_gid), path, "g-w");
  }
}

/// In one with the sticky bit, as /tmp, nobody renames what is another's.
void expect_nobody_renames_in(const fs::path& folder) {
  struct ::stat about {};
  if (::stat(folder.c_str(), &about) != 0) return;
  if ((about.st_mode & S_IWOTH) != 0 && (about.st_mode & S_ISVTX) == 0) refuse_writers("everybody", folder, "o-w");
}

void expect_safe_folder(const fs::path& folder) {
  expect_owner_writes(folder);
  for (fs::path above = folder.parent_path(); above != above.parent_path(); above = above.parent_path()) {
    expect_nobody_renames_in(above);
  }
}

}  // namespace

void expect_written_by_owner(const std::string& file) {
  std::error_code missing;
  const fs::path end = fs::canonical(file, missing);
  const fs::path folder = missing ? fs::path() : fs::canonical(fs::absolute(file).parent_path(), missing);
  if (missing) return;
  expect_owner_writes(end);
  expect_safe_folder(folder);
  expect_safe_folder(end.parent_path());
}

}  // namespace forcebound::driver
