#include "forcebound/text/file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace forcebound::text {

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
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file.write(content.data(), static_cast<std::streamsize>(content.size())).flush()) {
    throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
  }
}

}  // namespace forcebound::text
