#include "forcebound/server/scene/text.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace forcebound::server {
namespace {

TEST(Text, NumbersReadBackAsThemselves) {
  EXPECT_EQ(to_text(50000), "50000");
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-1e-300), "-1e-300");
}

TEST(Text, SuggestsTheNearestName) {
  const std::vector<std::string> known{"box", "circle", "sphere"};
  EXPECT_EQ(suggestion("spere", known), ", did you mean 'sphere'?");
  EXPECT_EQ(suggestion("circel", known), ", did you mean 'circle'?");
}

TEST(Text, SuggestsNothingForAnotherWord) {
  const std::vector<std::string> known{"box", "circle", "sphere"};
  EXPECT_EQ(suggestion("temperature", known), "");
  EXPECT_EQ(suggestion("", known), "");
}

}  // namespace
}  // namespace forcebound::server
