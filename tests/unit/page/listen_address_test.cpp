#include "forcebound/page/listen_address.hpp"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <stdexcept>
#include <string>

namespace forcebound::page {
namespace {

constexpr const char* kVariable = "FORCEBOUND_PAGE_TOKEN";

class APagesToken : public testing::Test {
 protected:
  void TearDown() override { unsetenv(kVariable); }
};

TEST_F(APagesToken, IsRandomUnlessTheEnvironmentGivesOne) {
  const std::string one = page_settings({}, "/nowhere/bin/program").token;
  EXPECT_EQ(one.size(), 32U);
  EXPECT_NE(one, page_settings({}, "/nowhere/bin/program").token);
  const std::string given = "0123456789abcdef0123456789abcdef";
  setenv(kVariable, given.c_str(), 1);
  EXPECT_EQ(page_settings({}, "/nowhere/bin/program").token, given);
}

TEST_F(APagesToken, OfTheEnvironmentIsRefusedIfItIsNoneAndNotRepeated) {
  for (const std::string wrong :
       {"", "secret", "0123456789ABCDEF0123456789ABCDEF", "0123456789abcdef0123456789abcdef0"}) {
    setenv(kVariable, wrong.c_str(), 1);
    try {
      (void)page_settings({}, "/nowhere/bin/program");
      ADD_FAILURE() << wrong;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("must have 32 digits of 0 to 9 and a to f"));
      if (wrong.empty()) continue;
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr(wrong)));
    }
  }
}

}  // namespace
}  // namespace forcebound::page
