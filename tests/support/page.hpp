#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include "forcebound/text/marks.hpp"
#include "tests/support/process.hpp"
#include "tests/support/source_folder.hpp"

/// Parts of the repository's pages that are the output of programs.
namespace forcebound::test {

/// Whether deploy/pages runs the tests, so that they write the pages instead of comparing them.
inline bool writes_pages() { return std::getenv("FORCEBOUND_WRITE_PAGES") != nullptr; }

/// Replaces the part between the marks NAME of a page, or hands it to `compare`.
/// @param page relative to the source tree
inline void replace_or_compare(const std::string& page, const std::string& name, const std::string& part,
                               const std::function<void(std::string_view on_page)>& compare) {
  const std::string begin = "<!-- " + name + ": made by deploy/pages -->\n";
  const std::string end = "<!-- /" + name + " -->\n";
  const text::Marks marks{.begin = begin, .end = end};
  const auto file = source_folder() / page;
  SCOPED_TRACE(page + ", " + name + "; after a change that is wanted run: deploy/pages");
  const std::string document = content(file);
  if (writes_pages()) {
    write_file(file, text::with_between_marks(document, marks, part));
  } else {
    compare(text::between_marks(document, marks));
  }
}

/// The part of a page is exactly this.
inline void expect_on_page(const std::string& page, const std::string& name, const std::string& part) {
  replace_or_compare(page, name, part, [&](std::string_view on_page) { EXPECT_EQ(on_page, part); });
}

}  // namespace forcebound::test
