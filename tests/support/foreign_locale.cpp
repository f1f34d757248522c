// Loaded into programs before they begin (LD_PRELOAD): from then on the locale of C and of C++ has a comma for the
// point and points between thousands, as a driver may choose it at any time.

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <iostream>  // makes the standard streams, which keep the locale from before
#include <locale>
#include <stdexcept>

namespace {

bool choose() {
  try {
    std::locale::global(std::locale("de_DE.UTF-8"));
    std::setlocale(LC_MESSAGES, "C");  // tests read the system's words for errors
    ::unsetenv("LD_PRELOAD");          // gnuplot is not ours
    return true;
  } catch (const std::runtime_error&) {
    std::fputs("no locale de_DE.UTF-8: LOCPATH must name a folder that has it\n", stderr);
    std::_Exit(99);
  }
}

[[maybe_unused]] const bool kChosen = choose();

}  // namespace
