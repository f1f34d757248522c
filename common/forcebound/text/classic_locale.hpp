#pragma once

namespace forcebound::text {

/// During its lifetime the process's locale is the classic one, in C and in C++, for libraries that read numbers by it:
/// a driver or a program around may have chosen one with a comma for the point. Several may live at once, on any
/// threads; with the last the locale before the first comes back.
class ClassicLocale {
 public:
  ClassicLocale();
  ~ClassicLocale();
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;
};

}  // namespace forcebound::text
