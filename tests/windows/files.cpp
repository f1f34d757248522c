#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "forcebound/text/file.hpp"

namespace {

namespace fs = std::filesystem;
namespace text = forcebound::text;

int expected = 0;
int failures = 0;

void expect(bool holds, const char* what) {
  ++expected;
  if (holds) return;
  std::printf("not so: %s\n", what);
  ++failures;
}

/// Whether reading it is refused, with these words.
bool refuses_to_read(const std::string& path, const std::string& words, std::size_t bytes_most = 1000) {
  try {
    (void)text::read_file(path, bytes_most);
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).find(path + ": cannot be read: ") == 0 &&
           std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

bool may_be_written(const std::string& path) {
  try {
    text::expect_writable(path);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace

/// What forcebound/text/file.hpp promises of files, on the system that this runs on; in an empty working directory.
int main() {
  const std::string content("one\r\n\0two\n\xff", 11);
  text::write_file("new", content);
  expect(text::read_file("new") == content, "every byte of a new file comes back");
  text::write_file("new", "short");
  expect(text::read_file("new") == "short", "a file is replaced");
  text::write_file("gr\u00f6\u00dfe", "1");
  expect(text::read_file("gr\u00f6\u00dfe") == "1" && may_be_written("gr\u00f6\u00dfe"), "names are UTF-8");
  fs::remove(fs::path("gr\u00f6\u00dfe"));
  expect(std::distance(fs::directory_iterator("."), {}) == 1, "nothing is left beside it");
  expect(refuses_to_read("missing", "No such file"), "a missing file is refused");
  expect(refuses_to_read("new", "more than 4 bytes", 4), "one that is too large is refused");
  fs::create_directory("folder");
  expect(refuses_to_read("folder", "it is a directory"), "a folder is refused");
  expect(may_be_written("new") && text::read_file("new") == "short", "to try changes nothing");
  expect(may_be_written("another") && !fs::exists("another"), "to try leaves nothing");
  expect(!may_be_written("folder") && !may_be_written("no/such/folder"), "a folder cannot be written");
  expect(text::is_same_path("new", "folder/../new") && !text::is_same_path("new", "folder"), "paths are compared");
  expect(text::path_within("new", ".") == (fs::path(".") / "new").string(), "a file of the folder is within");
  expect(fs::exists(text::program_path()), "the program knows its file");
  std::printf("%d of %d do not hold\n", failures, expected);
  return failures == 0 ? 0 : 1;
}
