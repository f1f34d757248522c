#include <windows.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "forcebound/text/file.hpp"
#include "forcebound/text/internal/file_problems.hpp"

namespace forcebound::text {
namespace {

namespace fs = std::filesystem;

std::error_code last_error() { return {static_cast<int>(::GetLastError()), std::system_category()}; }

/// @returns what failed
std::error_code put(const fs::path& path, std::string_view content) {
  ::SetLastError(ERROR_WRITE_FAULT);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  return file ? std::error_code() : last_error();
}

/// An open file, closed at the end.
class Handle {
 public:
  explicit Handle(HANDLE handle) noexcept : handle_(handle) {}
  ~Handle() {
    if (is_open()) ::CloseHandle(handle_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] bool is_open() const noexcept { return handle_ != INVALID_HANDLE_VALUE; }
  [[nodiscard]] HANDLE get() const noexcept { return handle_; }

 private:
  HANDLE handle_;
};

}  // namespace

std::string read_file(const std::string& path, std::size_t bytes_most) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) refuse_reading(path, std::make_error_code(std::errc::no_such_file_or_directory).message());
  if (fs::is_directory(status)) refuse_reading(path, "it is a directory");
  if (!fs::is_regular_file(status)) refuse_reading(path, "it is no regular file");
  ::SetLastError(ERROR_READ_FAULT);
  std::ifstream in(fs::path(path), std::ios::binary);  // a string's bytes would be of the system's code page, not UTF-8
  if (!in) refuse_reading(path, last_error().message());
  std::string text;
  std::array<char, 1 << 16> part{};
  while (in.read(part.data(), part.size()) || in.gcount() > 0) {
    const auto bytes = static_cast<std::size_t>(in.gcount());
    if (bytes > bytes_most - text.size()) {
      refuse_reading(path, "it has more than " + std::to_string(bytes_most) + " bytes, expected at most that");
    }
    text.append(part.data(), bytes);
  }
  if (in.bad()) refuse_reading(path, last_error().message());
  return text;
}

void write_file(const std::string& path, std::string_view content) {
  const fs::path successor = path + ".new-" + std::to_string(::GetCurrentProcessId());
  if (std::error_code error = put(successor, content); !error) {
    fs::rename(successor, path, error);
    if (!error) return;
  }
  std::error_code ignored;
  fs::remove(successor, ignored);
  if (const std::error_code error = put(path, content)) throw WriteError(not_writable(path, error.message()));
}

void expect_writable(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) refuse_writing(path, "it is a directory");
  const bool there = fs::exists(path, ignored);
  const Handle file(::CreateFileW(fs::path(path).c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                  there ? OPEN_EXISTING : CREATE_NEW,
                                  there ? FILE_ATTRIBUTE_NORMAL : FILE_FLAG_DELETE_ON_CLOSE, nullptr));
  if (!file.is_open()) refuse_writing(path, last_error().message());
}

fs::path program_path() {
  std::wstring path(std::size_t{1} << 15U, L'\0');  // the longest that Windows has
  path.resize(::GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return path;
}

}  // namespace forcebound::text
