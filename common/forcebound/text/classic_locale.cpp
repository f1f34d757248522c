#include "forcebound/text/classic_locale.hpp"

#include <clocale>
#include <locale>
#include <mutex>
#include <string>

namespace forcebound::text {
namespace {

struct Shared {
  std::mutex lock{};
  int users = 0;
  std::string c_before{};
  std::locale cpp_before{};
};

Shared& shared() {
  static Shared all;
  return all;
}

}  // namespace

ClassicLocale::ClassicLocale() {
  Shared& all = shared();
  const std::lock_guard alone(all.lock);
  if (all.users++ > 0) return;
  const char* const name = std::setlocale(LC_ALL, nullptr);
  all.c_before = name != nullptr ? name : "C";
  all.cpp_before = std::locale::global(std::locale::classic());
}

ClassicLocale::~ClassicLocale() {
  Shared& all = shared();
  const std::lock_guard alone(all.lock);
  if (--all.users > 0) return;
  // In this order: the one of C++ sets that of C too, if it has a name.
  std::locale::global(all.cpp_before);
  std::setlocale(LC_ALL, all.c_before.c_str());
}

}  // namespace forcebound::text
