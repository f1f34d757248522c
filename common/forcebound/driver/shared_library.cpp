#include "forcebound/driver/shared_library.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "forcebound/driver/crash.hpp"
#include "forcebound/driver/written_by_owner.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".so";

/// The plug-in's name in a file's name; empty: it is none of that kind.
std::string plugin_named_by(const fs::path& file, std::string_view prefix) {
  const std::string name = file.filename().string();
  if (name.size() <= prefix.size() + kSuffix.size() || !name.starts_with(prefix) || !name.ends_with(kSuffix)) return {};
  return name.substr(prefix.size(), name.size() - prefix.size() - kSuffix.size());
}

/// Of a file in the format of shared libraries; nothing: it is none.
std::optional<Elf64_Half> processor_of(const std::string& file) {
  // The fields up to this one are the same in files of 32 bits.
  struct {
    unsigned char ident[EI_NIDENT];
    Elf64_Half type;
    Elf64_Half machine;
  } header{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
  if (std::memcmp(header.ident, ELFMAG, SELFMAG) != 0) return std::nullopt;
  return header.machine;
}

std::string words_of_processor(Elf64_Half machine) {
  switch (machine) {
    case EM_386:
      return "x86 (32 bit)";
    case EM_X86_64:
      return "x86-64";
    case EM_ARM:
      return "Arm (32 bit)";
    case EM_AARCH64:
      return "AArch64";
    case EM_RISCV:
      return "RISC-V";
    default:
      return "ELF machine " + std::to_string(machine);
  }
}

}  // namespace

std::vector<std::string> plugin_folders(const PluginKind& kind, const char* path, const std::string& program) {
  std::vector<std::string> folders;
  std::string_view rest = path == nullptr ? std::string_view{} : std::string_view{path};
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  const fs::path beside = fs::path(program).parent_path();
  folders.push_back((beside.parent_path() / "lib" / "forcebound" / kind.folder).string());
  return folders;
}

std::optional<std::string> find_plugin(const PluginKind& kind, std::string_view name,
                                       const std::vector<std::string>& folders) {
  // A name is never a path.
  if (name.empty() || name.find('/') != std::string_view::npos) return std::nullopt;
  const std::string file = std::string(kind.prefix) + std::string(name) + std::string(kSuffix);
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder) / file;
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return path.string();
  }
  return std::nullopt;
}

std::vector<std::string> plugins_in(const PluginKind& kind, const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    for (fs::directory_iterator file(folder, ignored); file != fs::directory_iterator(); file.increment(ignored)) {
      if (std::string name = plugin_named_by(file->path(), kind.prefix); !name.empty())
        names.push_back(std::move(name));
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

SharedLibrary::SharedLibrary(const PluginKind& kind, const std::string& file)
    : kind_(kind), file_(file), library_(nullptr) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) refuse("cannot be loaded: there is no such file");
  try {
    expect_written_by_owner(file);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
  // Of one for another processor the system says that it is not there.
  const auto processor = processor_of(file);
  if (!processor) refuse("cannot be loaded: it is no shared library");
  if (const auto own = processor_of("/proc/self/exe"); own && *own != *processor) {
    refuse("cannot be loaded: it is for " + words_of_processor(*processor) + ", this program for " +
           words_of_processor(*own));
  }
  const CallInProgress in_progress(file_.c_str(), "its library's initialisers", kind.name);
  // A name without a slash would be looked for elsewhere. All of it now, not while the tick runs; and with names of its
  // own, lest two vendors' libraries meet.
  const std::string path = file.find('/') == std::string::npos ? "./" + file : file;
  library_ = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library_ != nullptr) return;
  const char* const why = ::dlerror();
  refuse("cannot be loaded: " + text::printable(why == nullptr ? "unknown error" : why));
}

SharedLibrary::~SharedLibrary() { ::dlclose(library_); }

const void* SharedLibrary::called(unsigned interface, const void* (*call)(void* entry, unsigned interface)) const {
  void* const entry = ::dlsym(library_, kind_.entry);
  if (entry == nullptr) {
    refuse(std::string("is no ") + kind_.name + ": it lacks the function '" + kind_.entry + "' of " + kind_.header);
  }
  const CallInProgress in_progress(file_.c_str(), kind_.entry, kind_.name);
  const void* const table = call(entry, interface);
  if (table == nullptr) refuse("has no table of functions");
  return table;
}

void SharedLibrary::expect_function(bool there, const char* function) const {
  if (!there) refuse(std::string("lacks the function '") + function + "'; " + kind_.header + " names all");
}

void SharedLibrary::refuse(const std::string& why) const {
  throw std::runtime_error(kind_.name + (" " + text::printable(file_)) + ": " + why);
}

void SharedLibrary::refuse_interface(unsigned has, unsigned interface) const {
  refuse("has interface " + std::to_string(has) + ", this program has " + std::to_string(interface) +
         ": build it with this program's " + kind_.header);
}

}  // namespace forcebound::driver
