#include "forcebound/text/setting_names.hpp"

#include <gtest/gtest.h>

namespace forcebound::text {
namespace {

TEST(WithSettingNames, NamesEachOptionAsASetting) {
  EXPECT_EQ(with_setting_names("--listen: accepted are --key with --clients, or --psk"),
            "'listen': accepted are 'key' with 'clients', or 'shared_key'");
  EXPECT_EQ(with_setting_names("not the one of --server-key: somebody else answers, or --trust-new"),
            "not the one of 'server_key': somebody else answers, or 'trust_new'");
}

TEST(WithSettingNames, LeavesAllElseAsItIs) {
  for (const char* const text : {"", "no option", "1 -- 2", "--", "ends with --", "-47800", "--- a"}) {
    EXPECT_EQ(with_setting_names(text), text);
  }
}

}  // namespace
}  // namespace forcebound::text
